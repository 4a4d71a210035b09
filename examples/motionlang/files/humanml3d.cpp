// motionlang humanml3d: the data set HumanML3D from AMASS.
#include <cstdio>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/datasets/make_humanml3d.hpp>

#include "../commands.hpp"
#include "../machine_options.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"
#include "motion_files.hpp"

namespace program {

namespace {

struct HumanMl3dCommand {
  ml::HumanMl3dSources sources;
  std::filesystem::path out;
  ml::HumanMl3dMaking making;
  bool corrected = false;
  MachineOptions machine;
};

void run(const HumanMl3dCommand& o) {
  o.machine.apply();
  make_output_folder("--out", o.out);
  ml::HumanMl3dMaking making = o.making;
  if (o.corrected) making.features = ml::guoh3d_corrected();
  ProgressBar bar("making clips");
  const ml::MadeHumanMl3d made = ml::make_humanml3d<ml::EigenBackend<float>>(o.sources, o.out, making, bar);
  bar.finish();
  std::printf("%s: %s made, %td were there, %td without captions, %td with values that are not finite\n%s\n",
              o.out.string().c_str(), ml::counted(made.made, "clip").c_str(), made.there, made.captionless,
              made.not_finite, made.left_out.text().c_str());
}

}  // namespace

void add_humanml3d(CLI::App& app) {
  const auto o = std::make_shared<HumanMl3dCommand>();
  CLI::App* c = app.add_subcommand(
      "humanml3d",
      "Makes the data set HumanML3D from AMASS: joints, mirrored clips, features, statistics and lists. The same "
      "command continues after a stop");
  folder_option(*c, "--repository", o->sources.repository,
                "Checkout of github.com/EricGuo5513/HumanML3D, with HumanML3D/texts.zip and pose_data/humanact12.zip "
                "unpacked")
      ->required();
  folder_option(*c, "--amass", o->sources.amass, "Folder of AMASS, the downloads \"SMPL+H G\" of any release")
      ->required();
  folder_option(*c, "--bodies", o->sources.bodies,
                "Folder of the bodies of SMPL-H, such as smplh/male/model.npz and smplh/female/model.npz")
      ->required();
  c->add_option("--out", o->out, "Folder for the data set")->required();
  c->add_flag("--mirrored,!--no-mirrored", o->making.mirrored, "Also make mirrored clips, whose names begin with M")
      ->capture_default_str();
  c->add_flag("--missing", o->making.missing,
              "Leave out clips whose file is missing. Without this, missing files are an error, before the work");
  c->add_flag("--corrected", o->corrected,
              "Compute the features without four errors of the published code (features/guoh3d_extraction.hpp). "
              "Published models expect the errors");
  o->machine.add_to(*c);
  c->callback([o] { run(*o); });
}

}  // namespace program
