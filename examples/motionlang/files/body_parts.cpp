// motionlang body-parts: questions to a language model about the body parts of actions, its answers as a table, and how
// often answers agree with people.
#include <cstdio>
#include <map>
#include <optional>

#include <motionlang/datasets/body_part_lines.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/input_files.hpp>
#include <motionlang/train/body_part_evaluation.hpp>

#include "../commands.hpp"
#include "../formatted.hpp"
#include "../progress_bar.hpp"

namespace program {

namespace {

namespace ml = motionlang;

struct BodyPartOptions {
  std::filesystem::path babel, labels, spelling, answers, truth, data, prompts, table;
  ml::BodyPartPrompt form = ml::BodyPartPrompt::few_shot;
};

/// Table B.1.
void print_accuracies(const BodyPartOptions& o, const ml::BodyPartAnswers* answers) {
  const auto truth = ml::parse_body_part_truth(ml::read_file(o.truth), o.truth.string());
  std::vector<ml::DescribedMotion> motions;
  if (!o.data.empty()) {
    ProgressBar bar("reading motions");
    motions = ml::labelled_motions({o.data, o.babel, {}, {}, o.spelling}, bar);
  }
  print(ml::labellers_table(truth, ml::labeller_accuracies(truth, o.data.empty() ? nullptr : &motions, answers)));
}

void run(const BodyPartOptions& o) {
  const ml::InputFiles inputs{o.babel, o.labels, o.spelling, o.answers, o.truth};
  for (const auto& file : {o.prompts, o.table}) inputs.refuse(file);
  std::optional<ml::BodyPartAnswers> answers;
  if (!o.answers.empty()) answers = ml::read_body_part_answers(o.answers);
  if (o.truth.empty() && o.babel.empty() && o.labels.empty() && o.table.empty())
    ml::raise<usage_error>(102, "--babel or --labels is required, or --truth, or --table with --answers");
  if (!o.table.empty()) {
    if (!answers) ml::raise<usage_error>(102, "--table needs --answers");
    ml::write_file(o.table, std::string_view(ml::body_part_table_text(*answers)));
    std::printf("%s  %s\n", ml::counted(answers->size(), "answer").c_str(), o.table.string().c_str());
  }
  if (!o.truth.empty()) return print_accuracies(o, answers ? &*answers : nullptr);
  if (o.babel.empty() && o.labels.empty()) return;
  const auto all =
      o.babel.empty() ? ml::parse_label_list(ml::read_file(o.labels)) : ml::babel_labels(o.babel, o.spelling);
  const auto open = ml::unanswered_labels(all, answers.value_or(ml::BodyPartAnswers()));
  const std::string lines = ml::body_part_questions(open, o.form);
  if (o.prompts.empty()) {
    print(lines);
  } else {
    ml::write_file(o.prompts, std::string_view(lines));
    std::printf("%s of %zu without an answer  %s\n", ml::counted(open.size(), "label").c_str(), all.size(),
                o.prompts.string().c_str());
  }
}

}  // namespace

void add_body_parts(CLI::App& app) {
  const auto o = std::make_shared<BodyPartOptions>();
  CLI::App* c = app.add_subcommand(
      "body-parts",
      "Writes the questions that SINC asks a language model about the body parts of actions, makes a table of its "
      "answers, and compares them with what people say");
  CLI::Option* babel =
      c->add_option("--babel", o->babel, "BABEL's JSON, whose labels are asked about")->check(CLI::ExistingFile);
  c->add_option("--labels", o->labels, "File with a label on each line instead")
      ->check(CLI::ExistingFile)
      ->excludes(babel);
  c->add_option("--spelling", o->spelling, "JSON of words in labels and their replacements")
      ->check(CLI::ExistingFile)
      ->needs(babel);
  c->add_option("--answers", o->answers,
                "Answers so far: lines of JSON with label and answer, or a table as SINC has it. Their labels are not "
                "asked about again, unless the answer names no part")
      ->check(CLI::ExistingFile);
  const std::map<std::string, ml::BodyPartPrompt> forms{{"free", ml::BodyPartPrompt::free_form},
                                                        {"list", ml::BodyPartPrompt::list},
                                                        {"few-shot", ml::BodyPartPrompt::few_shot}};
  c->add_option("--form", o->form, "Form of the questions, as rows a, b and c of table B.1. The default is few-shot")
      ->transform(CLI::CheckedTransformer(forms).description("free, list or few-shot"));
  c->add_option("--prompts", o->prompts, "File for the questions, a line of JSON for each. The default is the screen");
  c->add_option("--table", o->table, "File for the table of all answers, which train-sinc and generate read");
  c->add_option(
       "--truth", o->truth,
       "What people say: lines of a label and six columns (global, torso, left arm, right arm, left leg, right "
       "leg) of 0, 1, or 0.5 for sometimes. Prints the accuracies of table B.1 instead of questions")
      ->check(CLI::ExistingFile);
  c->add_option(
       "--data", o->data,
       "With --truth and --babel: folder of the motions, for the row of velocities. The paths feat_p lead into "
       "it")
      ->check(CLI::ExistingDirectory)
      ->needs(babel);
  c->callback([o] { run(*o); });
}

}  // namespace program
