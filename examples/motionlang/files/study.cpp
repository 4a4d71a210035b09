// motionlang study, study-count: a page on which raters compare motions or texts, and what they answered.
#include <cstdio>

#include <motionlang/generate/timeline_tracks.hpp>
#include <motionlang/metrics/study_counts.hpp>
#include <motionlang/view/study_chart.hpp>
#include <motionlang/view/study_page.hpp>

#include "../commands.hpp"
#include "../formatted.hpp"
#include "../generate/timelines.hpp"
#include "../option_checks.hpp"
#include "motion_files.hpp"

namespace program {

namespace {

struct StudyCommand {
  std::string table, kind = "pairs", out = "study.html";
  ml::StudyPageOptions page;
  bool hide_text = false;
};

void run(const StudyCommand& o) {
  const ml::Study study = ml::parse_study(ml::read_file(o.table), ml::parse_study_kind(o.kind), o.table);
  const std::filesystem::path folder = std::filesystem::path(o.table).parent_path();
  ml::InputFiles inputs{o.table};
  const auto file = [&](const std::string& name) {
    inputs.add(folder / name);
    return folder / name;
  };
  const ml::StudyFiles files{.motion = [&](const std::string& name) { return read_only_performed_motion(file(name)); },
                             .timeline =
                                 [&](const std::string& name) {
                                   constexpr double fps = 20;
                                   const auto timelines = read_timelines(file(name).string(), fps);
                                   return ml::timeline_tracks(timelines.front(), fps);
                                 }};
  ml::StudyPageOptions page = o.page;
  page.show_text = !o.hide_text;
  if (page.question.empty()) page.question = ml::study_question(study, page.show_text);
  if (page.title.empty()) page.title = page.question;
  const std::string html = ml::study_html(study, files, page);
  inputs.refuse(o.out);
  ml::write_file(std::filesystem::path(o.out), html);
  std::printf("%s: %s, seed %llu\n", o.out.c_str(),
              ml::describe_trials(study, ml::study_trials(study, page.seed)).c_str(),
              static_cast<unsigned long long>(page.seed));
}

struct StudyCountCommand {
  std::string table, kind = "pairs", svg;
  std::vector<std::string> answers;
  double pass = 1;
};

void run(const StudyCountCommand& o) {
  const ml::Study study = ml::parse_study(ml::read_file(o.table), ml::parse_study_kind(o.kind), o.table);
  std::vector<ml::StudyAnswers> answers;
  for (const std::string& file : o.answers)
    answers.push_back(ml::parse_study_answers(ml::read_file(file), study, file));
  const ml::StudyCounts counts = ml::count_study(study, answers, o.pass);
  print(ml::describe_raters(counts, o.answers));
  print(ml::study_table(study, counts));
  if (o.svg.empty()) return;
  ml::InputFiles inputs(o.answers);
  inputs.add(o.table);
  inputs.refuse(o.svg);
  ml::write_file(std::filesystem::path(o.svg), ml::bar_chart_svg(ml::study_chart(study, counts)));
}

constexpr const char* study_table_help =
    "Table of the study, with tabs between columns. The first line names them: text, role (warmup, or catch and the "
    "right column), timeline, motion (if texts are compared), and one column for each system with its files or texts";
constexpr const char* study_kind_help =
    "pairs: the better of two, for all pairs of systems; ranking: all systems in order; rating: one at a time, from 1 "
    "to 5";

CLI::Option* add_kind(CLI::App& c, std::string& kind) {
  return checked_option(c, "--kind", kind, CLI::IsMember({"pairs", "ranking", "rating"}), study_kind_help);
}

}  // namespace

void add_study(CLI::App& app) {
  const auto o = std::make_shared<StudyCommand>();
  o->page.title = "";
  CLI::App* c = app.add_subcommand("study",
                                   "Writes a perceptual study as one page: raters compare moving figures or texts, and "
                                   "save their answers as a file");
  file_option(*c, "table", o->table, study_table_help)->required();
  add_kind(*c, o->kind);
  checked_option(*c, "-o,--out", o->out, not_empty(), "The page (.html)");
  checked_option(*c, "--seed", o->page.seed, seed_number(),
                 "Seed of the order of trials and sides; another seed is another page");
  c->add_option("--question", o->page.question, "The question above each trial. The default depends on the kind");
  c->add_option("--title", o->page.title, "Title of the page. The default is the question");
  c->add_option("--instructions", o->page.instructions, "What raters read first. The default depends on the kind");
  c->add_flag("--hide-text", o->hide_text, "Show neither texts nor timelines, as in a study of realism");
  c->add_flag("--no-preference", o->page.no_preference, "With pairs: raters may also have no preference");
  c->callback([o] { run(*o); });
}

void add_study_count(CLI::App& app) {
  const auto o = std::make_shared<StudyCountCommand>();
  CLI::App* c = app.add_subcommand(
      "study-count",
      "Counts the answers to a study: majorities, mean ranks or ratings with 95 % intervals, without raters who fail "
      "catch trials");
  file_option(*c, "table", o->table, "Table of the study, as `study` read it")->required();
  file_option(*c, "answers", o->answers, "Files that raters saved")->required();
  add_kind(*c, o->kind);
  c->add_option("--svg", o->svg, "Also draw the counts as bars, into this file")->check(not_empty());
  checked_option(*c, "--pass", o->pass, in_range(0, 1), "Share of catch trials that a rater must pass");
  c->callback([o] { run(*o); });
}

}  // namespace program
