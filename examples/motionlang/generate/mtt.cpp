// motionlang mtt: timelines for evaluation, drawn from a list of texts, and those of the baselines.
#include <cstdint>
#include <cstdio>

#include <motionlang/compose/mtt_timelines.hpp>
#include <motionlang/file/input_files.hpp>
#include <motionlang/file/output_folder.hpp>

#include "../commands.hpp"
#include "../option_checks.hpp"
#include "timelines.hpp"

namespace program {

namespace {

struct MttCommand {
  std::string texts, out = "mtt";
  ml::MttOptions options;

  static constexpr const char *multi_track = "MTT.txt", *single_track = "MTT_singletrack.txt",
                              *one_text = "MTT_onetext.txt";
};

void run(const MttCommand& o) {
  const ml::OutputFolder folder("--out", o.out);
  const auto file = [&](const char* name) { return std::filesystem::path(o.out) / name; };
  for (const char* name : {MttCommand::multi_track, MttCommand::single_track, MttCommand::one_text})
    ml::InputFiles{o.texts}.refuse(file(name));
  const auto texts = ml::parse_mtt_texts(read_timeline_text(o.texts), timeline_source(o.texts));
  const auto timelines = ml::mtt_timelines(texts, o.options);
  double seconds = 0;
  for (const ml::TimelineInSeconds& t : timelines) seconds += t.end();
  const ml::MttFiles files = ml::mtt_files(timelines);
  std::printf("%s of %s, %.2f s each\n", counted(timelines.size(), "timeline").c_str(),
              counted(texts.size(), "text").c_str(), seconds / static_cast<double>(timelines.size()));
  const auto write = [&](const char* name, const std::string& contents, const char* about) {
    ml::write_file(file(name), contents);
    std::printf("  %-40s %s\n", file(name).string().c_str(), about);
  };
  write(MttCommand::multi_track, files.multi_track, "three texts on two tracks");
  write(MttCommand::single_track, files.single_track, "the same on one track, for DiffCollage");
  write(MttCommand::one_text, files.one_text, "the same in one sentence");
}

}  // namespace

void add_mtt(CLI::App& app) {
  const auto o = std::make_shared<MttCommand>();
  CLI::App* c = app.add_subcommand(
      "mtt",
      "Draws timelines of three texts on two tracks from a list of texts, as STMC's data set MTT has them. Writes "
      "MTT.txt, and the timelines of two baselines: MTT_singletrack.txt and MTT_onetext.txt");
  file_option(*c, "--texts", o->texts,
              "File with a line for each text: 'text # body part # ...'. With STMC's texts.txt, the files are the "
              "published ones, byte for byte")
      ->required();
  checked_option(*c, "--out", o->out, not_empty(), "Folder for the files");
  checked_option(*c, "--seed", o->options.seed, in_range(0, 1e15), "Seed of the draws");
  checked_option(*c, "--count", o->options.count, in_range(1, 1000000), "Number of timelines");
  c->callback([o] { run(*o); });
}

}  // namespace program
