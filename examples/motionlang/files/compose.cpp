// motionlang compose, join: one motion out of several, at the same time or one after the other.
#include <cstdio>
#include <optional>

#include <motionlang/compose/sinc_composition.hpp>
#include <motionlang/compose/text_sinc_parts.hpp>
#include <motionlang/datasets/body_part_table.hpp>
#include <motionlang/kinematics/join_motions.hpp>
#include <motionlang/kinematics/match_motion.hpp>

#include "../commands.hpp"
#include "../formatted.hpp"
#include "../option_checks.hpp"
#include "motion_files.hpp"

namespace program {

namespace {

struct ComposeOptions {
  std::vector<std::string> in;
  std::string out, first, second, table;
  MotionReadOptions read;
  bool center = false;
  double blend = 0.3, units = 100;
};

void write(const ComposeOptions& o, const ml::Motion& m) { print(write_motion(o.out, m, o.units)); }

void compose(const ComposeOptions& o) {
  require_folder_of(o.out);
  ml::InputFiles(o.in).refuse(o.out);
  const auto clip = [&](const std::string& file) {
    return on_smpl(read_only_performed_motion(file, ml::options_for_file(o.read, file)));
  };
  const ml::Motion first = clip(o.in[0]), second = ml::match_motion(clip(o.in[1]), first);
  std::optional<ml::BodyPartTable> table;
  if (!o.table.empty()) table = ml::open_body_part_table(o.table);
  const auto parts_of = [&](const std::string& text) { return ml::text_sinc_parts(text, table ? &*table : nullptr); };
  const ml::SincParts of_first = parts_of(o.first), of_second = parts_of(o.second);
  std::printf("%s: %s\n%s: %s\n", o.in[0].c_str(), ml::list_sinc_parts(of_first).c_str(), o.in[1].c_str(),
              ml::list_sinc_parts(of_second).c_str());
  if (of_first.all() && of_second.all())
    ml::raise<usage_error>(102, "compose: both motions have all parts, nothing of '", first.name,
                           "' would remain: limit one of them by --first or --second");
  if (!ml::are_compatible(of_first, of_second) && !o.first.empty())
    std::printf("both motions claim %s; the one with fewer parts gets them\n",
                ml::list_sinc_parts(of_first & of_second).c_str());
  write(o, ml::compose_motions(first, of_first, second, of_second,
                               o.center ? ml::SincTrim::both_ends : ml::SincTrim::end));
}

void join(const ComposeOptions& o) {
  require_folder_of(o.out);
  ml::InputFiles(o.in).refuse(o.out);
  std::optional<ml::Motion> whole;
  for (const std::string& file : o.in) {
    for (ml::Motion& m : read_performed_motions(file, ml::options_for_file(o.read, file)))
      whole = whole ? ml::join_motions(*whole, std::move(m), o.blend) : std::move(m);
  }
  whole->name = std::filesystem::path(o.out).stem().string();
  write(o, *whole);
}

void add_output(CLI::App& c, ComposeOptions& o) {
  c.add_option("-o,--output", o.out, "Result: .bvh, .glb, .npz (AMASS), .npy (joints), .html (page), .svg or .png")
      ->required()
      ->check(not_empty());
  checked_option(c, "--units", o.units, positive(), "Units per metre of a BVH result");
  o.read.add_to(c);
}

}  // namespace

void add_compose(CLI::App& app) {
  const auto o = std::make_shared<ComposeOptions>();
  CLI::App* c = app.add_subcommand(
      "compose",
      "Combines two motions into one that performs both at the same time. Each motion gives the body parts that its "
      "action needs, by the rule of SINC; legs, pelvis and path stay together. A T-pose in front of a recording is "
      "left "
      "out");
  c->add_option("motions", o->in,
                "Two motion files, as for convert. The result has the rate and bones of the first, on SMPL's joints")
      ->required()
      ->expected(2)
      ->check(CLI::ExistingFile);
  const std::string parts =
      "Body parts that the %s motion gives: global, torso, left arm, right arm, left leg, right leg, separated by "
      "commas. "
      "Or a text, from which the parts are guessed";
  const auto of = [&](const char* which) { return std::string(parts).replace(parts.find("%s"), 2, which); };
  c->add_option("--first", o->first, of("first") + ". The default is all")->check(not_empty());
  c->add_option("--second", o->second, of("second"))->required()->check(not_empty());
  file_option(*c, "--table", o->table,
              "Body parts of texts from a language model, as SINC has them: JSON, text -> answers");
  c->add_flag("--center", o->center, "Cut the longer motion at both ends, not only at its end");
  add_output(*c, *o);
  c->callback([o] { compose(*o); });
}

void add_join(CLI::App& app) {
  const auto o = std::make_shared<ComposeOptions>();
  CLI::App* c =
      app.add_subcommand("join",
                         "Joins motions one after another. Each is turned and moved over the floor to start where the "
                         "one before it ends, and is blended into it. A T-pose in front of a recording is left out");
  c->add_option("motions", o->in, "Motion files, as for convert. The result has the rate and skeleton of the first")
      ->required()
      ->expected(1, -1)
      ->check(CLI::ExistingFile);
  checked_option(*c, "--blend", o->blend, not_negative(),
                 "Seconds over which one motion blends into the next, at least one frame");
  add_output(*c, *o);
  c->callback([o] { join(*o); });
}

}  // namespace program
