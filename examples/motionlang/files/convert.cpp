// motionlang convert, strip, view: a file of motion in, another file, a picture or a page out.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include <motionlang/features/motion_features.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/merged_body.hpp>
#include <motionlang/kinematics/edit_motion.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/retarget.hpp>

#include "../commands.hpp"
#include "../formatted.hpp"
#include "../generate/generation.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"
#include "box.hpp"
#include "input_files.hpp"
#include "motion_files.hpp"
#include "texts.hpp"
#include "weights.hpp"

namespace program {

namespace {

namespace fs = std::filesystem;

struct ConvertOptions {
  std::string in, out;  // out: "" of a folder: beside each motion
  std::string tensors, store, features;
  std::string denoise, action;            // a model, and the action that the motion shows
  ml::ModelSources sources;               // of this model
  std::string as;                         // of a folder: extension of what its files become
  std::string skeleton;                   // a motion on the skeleton that the result takes
  std::vector<std::string> hands;         // left, right: files of MANO that go into a file of SMPL-H
  const DataSetForm* data_set = nullptr;  // clips go into a folder of this form
  MotionReadOptions read;
  RigOptions rig;
  BodyOptions body;
  double scale = 100, fps = 0, from = 0, to = 0, speed = 1, loop = 0;
  bool smpl = false, mirror = false, smooth = false, fix_feet = false, in_place = false;
  bool replace = false;  // clips of the data set
};

/// What a motion becomes by --denoise; none without it. The model is loaded at once.
using Denoiser = std::function<ml::Motion(const ml::Motion&)>;
Denoiser denoiser_of(const ConvertOptions& o) {
  if (o.denoise.empty()) return {};
  const std::shared_ptr<const ml::MotionModel> generator = load_generator("eigen", o.denoise, o.sources);
  const ml::LatentMotionModel& model = require_latent(*generator, "--denoise", o.denoise);
  if (model.takes_actions() && o.action.empty())
    ml::raise<usage_error>(102, "ACTOR has to know which action a motion shows to denoise it: --action names it");
  if (!model.takes_actions() && !o.action.empty())
    ml::raise<usage_error>(102, "--action '", o.action, "' is for ACTOR; this model reads the motion alone");
  return [generator, &model, &o](const ml::Motion& m) { return model.denoised(m, o.action); };
}

/// What is read: motions and what the options name.
InputFiles inputs_of(const ConvertOptions& o, const std::vector<fs::path>& motions) {
  InputFiles inputs{o.rig.file, o.rig.joints,  o.body.file == "free" ? "" : o.body.file,
                    o.skeleton, o.read.joints, o.read.asf};
  for (const fs::path& file : motions) inputs.add(file);
  return inputs;
}

/// What the options name, read once for all files; null without the option.
struct Loaded {
  Loaded(const ConvertOptions& o, InputFiles read)
      : inputs(std::move(read)), rig(rig_writer(o.rig)), body(shown_body(o.body)), denoised(denoiser_of(o)) {
    if (!o.skeleton.empty()) skeleton = read_motions(o.skeleton, {.scale = 1 / o.scale}).front().skeleton;
  }
  InputFiles inputs;
  RigWriter rig;
  std::unique_ptr<const ShownBody> body;
  Denoiser denoised;
  std::optional<ml::Skeleton> skeleton;
};

/// Features that are not on the clip's own joints, arrays of positions and AMASS are on SMPL's joints, feet are fixed
/// there, and the user's body has these or its own.
bool wants_smpl(const ConvertOptions& o, const Loaded& loaded, const ml::Motion& m) {
  if (loaded.body != nullptr && !loaded.body->has_joints_of(m)) return true;
  if (loaded.body != nullptr && o.body.file != "free") return false;
  const bool others = !o.features.empty() && !ml::has_joints_of(ml::motion_features(o.features), m);
  const bool unknown_order = o.features.empty() && kind_of(o.out) == ".npy" && !ml::has_joints_of_arrays(m);
  return o.smpl || o.fix_feet || others || unknown_order || kind_of(o.out) == ".npz";
}

/// `report` is set if the joints were others than SMPL's and had to become these.
ml::Motion edited(ml::Motion m, const ConvertOptions& o, const Loaded& loaded, ml::RetargetReport& report) {
  if (const auto [first, last] = ml::frames_between(m, o.from, o.to); (o.from > 0 || o.to > 0) && first >= last)
    ml::raise<usage_error>(101, "convert: nothing of the ", m.seconds(), " s is between ", o.from, " and ",
                           o.to > 0 ? o.to : m.seconds(), " s");
  m = ml::edit_time(std::move(m), {.from = o.from, .to = o.to, .speed = o.speed, .fps = o.fps});
  if (loaded.denoised) m = loaded.denoised(m);
  const bool smpl = wants_smpl(o, loaded, m);
  m = ml::edit_motion(std::move(m),
                      {.smpl = smpl,
                       .mirror = o.mirror,
                       .smooth = o.smooth,
                       .fix_feet = o.fix_feet,
                       .in_place = o.in_place,
                       .loop = o.loop},
                      &report);
  if (loaded.skeleton && m.skeleton != *loaded.skeleton) m = ml::retarget(m, *loaded.skeleton);
  return m;
}

/// The longest side of the box around a rest pose, which stands, sits or lies.
double reach_of(const ml::Skeleton& skeleton) {
  if (skeleton.size() == 0) return 0;
  const Box box = box_of(skeleton.rest_positions());
  const auto size = box.high - box.low;
  return std::max({size.x, size.y, size.z});
}

/// The file of one motion of several: out_walk.bvh, and out_walk_2.bvh for another "walk". taken: such files without
/// extension.
fs::path name_of(fs::path out, const std::string& name, std::set<std::string>& taken) {
  const std::string extension = out.extension().string();
  return unique_name(out.replace_extension().string() + "_" + safe_file_name(name), taken) + extension;
}

/// The page or the strip of a motion that is given no name: under the motion's whole name, as NAME.html beside NAME.bvh
/// may be generate's.
fs::path beside(const fs::path& motion, const std::string& extension) { return motion.string() + extension; }

/// Converts one file into others. It collects the lines about them, for a caller who wants to show them.
class Conversion {
 public:
  /// taken: names that clips of a data set have already, or files.
  Conversion(const ConvertOptions& o, const Loaded& loaded, std::set<std::string>& taken)
      : o_(o), loaded_(loaded), taken_(taken) {
    if (kind_of(o.in) != ".npz")
      motions_ = read_motions(o.in, o.read, &about_input_);
    else if (loaded.body == nullptr)
      read_amass();
    else
      read_for_body();
  }

  void run() {
    ml::RetargetReport report;
    for (const ml::Motion& m : motions_) note(m);
    for (const ml::Motion& m : motions_) attempt(m.name, [&] { made_.push_back(edited(m, o_, loaded_, report)); });
    if (!report.table.empty()) told_ += to_string(report) + "\n";
    if (!made_.empty()) write();
    if (failures_ > 0)
      ml::raise<ml::config_error>(101, "convert: ", failures_, " of the ", ml::counted(motions_.size(), "motion"),
                                  " of ", o_.in, " could not be made:", reasons_);
  }
  /// Lines that begin with the name of the input: what it has and the result lacks.
  const std::string& about_input() const { return about_input_; }
  std::string told() const { return about_input_ + told_; }

 private:
  /// What somebody who converts a motion should know of it.
  void note(const ml::Motion& m) {
    const std::string where = o_.in + (motions_.size() == 1 ? "" : " " + m.name) + ": ";
    if (const ml::Index frames = ml::detect_t_pose_lead_in(m); frames > 0 && o_.from == 0)
      about_input_ +=
          where + formatted("begins with %s of a T-pose that was put in front; --from %.3g leaves out what was\n",
                            counted(frames, "frame").c_str(), static_cast<double>(frames) / m.fps);
    constexpr double smallest = 0.5, largest = 4;  // metres
    const double reach = reach_of(m.skeleton);
    if (reach > 0 && (reach < smallest || reach > largest))
      about_input_ +=
          where + formatted("the figure is %.2g m large%s\n", reach,
                            kind_of(o_.in) == ".bvh" ? ": --scale says how long a unit of the file is" : "");
  }
  /// Whose motion it is stays with AMASS files; joints and features do not have it, nor hands.
  void read_amass() {
    ml::AmassSequence sequence = ml::read_amass_sequence(o_.in, o_.read.rate);
    motions_.push_back(ml::amass_motion(sequence, fs::path(o_.in).stem().string()));
    const auto is_set = [](double x) { return x != 0; };
    bool hands = false;
    for (ml::Index f = 0; f < sequence.frames; ++f) {
      const auto columns = static_cast<std::size_t>(sequence.columns);
      const auto row = std::span(sequence.poses).subspan(static_cast<std::size_t>(f) * columns, columns);
      hands = hands || std::ranges::any_of(row.subspan(66), is_set);
    }
    const bool shape = std::ranges::any_of(sequence.betas, is_set) && kind_of(o_.out) != ".npz";
    if (hands || shape)
      about_input_ = o_.in + ": left out are " +
                     (hands && shape ? "hands, face and betas"
                      : hands        ? "hands and face"
                                     : "betas") +
                     "; --body shows them\n";
    amass_ = {std::move(sequence.gender), std::move(sequence.betas)};
  }

  void read_for_body() {
    BodyClip clip = loaded_.body->read(o_.in, o_.read.rate);
    motions_.push_back(std::move(clip.motion));
    betas_ = std::move(clip.betas);
    about_input_ = std::move(clip.told);
    if (loaded_.denoised && clip.has_more) about_input_ += o_.in + ": what --denoise makes is without hands and face\n";
  }

  /// Of several motions one that fails is reported and stops no other.
  template <class Work>
  void attempt(const std::string& name, Work work) {
    try {
      work();
    } catch (const ml::error& e) {
      if (motions_.size() == 1) throw;
      reasons_ += "\n" + name + ": " + e.what();
      ++failures_;
    }
  }

  void write() {
    loaded_.inputs.refuse(o_.out);
    if (loaded_.rig) {
      told_ += loaded_.rig(o_.out, made_);
    } else if (loaded_.body != nullptr && holds_several(o_.out)) {
      told_ += loaded_.body->write(o_.out, made_, betas_);
    } else if (motions_.size() > 1 && o_.features.empty() && holds_together(o_.out, made_)) {
      write_motions(o_.out, made_);
      told_ += ml::concat_text(o_.out, ": ", counted(made_.size(), "motion"), ", ",
                               counted(made_.front().skeleton.size(), "joint"), "\n");
    } else if (o_.data_set != nullptr) {
      for (const ml::Motion& m : made_)
        attempt(m.name, [&] {
          told_ +=
              write_humanml3d(o_.out, unique_name(safe_file_name(m.name), taken_), m, *o_.data_set, o_.fps, o_.replace);
        });
    } else {
      for (const ml::Motion& m : made_) {
        const auto path = motions_.size() == 1 ? fs::path(o_.out) : name_of(o_.out, m.name, taken_);
        attempt(m.name, [&] { told_ += write_one(path, m); });
      }
    }
  }

  std::string write_one(const fs::path& path, const ml::Motion& m) const {
    loaded_.inputs.refuse(path);
    if (loaded_.body != nullptr) return loaded_.body->write(path, {m}, betas_);
    if (!o_.features.empty()) return write_features(path, m, o_.features, o_.fps);
    return write_motion(path, m, {.scale = o_.scale, .body = amass_.value_or(ml::AmassBody{})});
  }

  const ConvertOptions& o_;
  const Loaded& loaded_;
  std::vector<ml::Motion> motions_;
  std::vector<float> betas_;            // of an AMASS file, for a body
  std::optional<ml::AmassBody> amass_;  // the same for another AMASS file
  std::set<std::string>& taken_;
  std::vector<ml::Motion> made_;
  std::string about_input_, told_, reasons_;
  std::size_t failures_ = 0;
};

/// Every motion file of a folder and of those below it, to the same place below another folder, or into a data set. One
/// that fails is reported and stops no other.
class FolderConversion {
 public:
  explicit FolderConversion(const ConvertOptions& o) : o_(o), files_(files_of(o)), loaded_(o, inputs_of(o, files_)) {}

  void run() {
    ProgressBar bar("converting");
    std::size_t done = 0;
    for (const fs::path& file : files_) {
      convert(file);
      if (!bar(static_cast<std::ptrdiff_t>(++done), std::ssize(files_)) && done < files_.size()) break;
    }
    bar.finish();
    for (const std::string& f : failures_) std::fprintf(stderr, "%s\n", f.c_str());
    tell();
    std::printf("%s: %zu of %s converted\n", (o_.out.empty() ? o_.in : o_.out).c_str(), done - failures_.size(),
                counted(files_.size(), "file").c_str());
    if (done < files_.size()) throw ml::cancelled();
    if (!failures_.empty())
      ml::raise<ml::config_error>(101, "convert: ", failures_.size(), " of the ", ml::counted(files_.size(), "file"),
                                  " of ", o_.in, " could not be converted");
  }

 private:
  /// What is read. Motions that are written must not stand among the originals: they could be in the place of a file
  /// that is still to be read. In a folder below them they are no originals of the next run.
  static std::vector<fs::path> files_of(const ConvertOptions& o) {
    const std::string kind = o.data_set != nullptr ? ".npy" : o.as;
    const bool are_motions = is_motion_file("a" + kind);
    if (are_motions && is_same_place(o.in, o.out))
      ml::raise<usage_error>(102, "convert: ", kind, " files of ", o.in,
                             " cannot go into the folder itself: name another one, which may be below it");
    auto files = motion_files_below(o.in, are_motions ? o.out : "");
    if (files.empty()) ml::raise<ml::config_error>(101, "convert: no motion file in ", o.in);
    return files;
  }

  void convert(const fs::path& file) {
    try {
      ConvertOptions one = o_;
      one.in = file.string();
      static_cast<ml::MotionReadOptions&>(one.read) = ml::options_for_file(o_.read, file);
      if (o_.out.empty()) {
        one.out = beside(file, o_.as).string();
      } else if (o_.data_set == nullptr) {
        const fs::path place = o_.out / file.lexically_relative(o_.in).replace_extension();
        fs::create_directories(place.parent_path());
        one.out = unique_name(place.string(), taken_) + o_.as;
      }
      Conversion conversion(one, loaded_, taken_);
      conversion.run();
      note(one.in, conversion.about_input());
    } catch (const std::exception& e) {
      failures_.push_back(file.string() + ": " + e.what());
    }
  }

  /// A line that is the same for many files is printed once.
  void note(const std::string& file, const std::string& about) {
    std::istringstream lines(about);
    for (std::string line; std::getline(lines, line);) {
      auto& [first, more] = told_[line.starts_with(file) ? line.substr(file.size()) : line];
      if (first.empty())
        first = line;
      else
        ++more;
    }
  }
  void tell() const {
    for (const auto& [about, said] : told_) {
      const auto& [first, more] = said;
      std::printf("%s%s\n", first.c_str(), more > 0 ? formatted(" (and of %td more)", more).c_str() : "");
    }
  }

  const ConvertOptions& o_;
  const std::vector<fs::path> files_;
  const Loaded loaded_;
  std::set<std::string> taken_;
  std::vector<std::string> failures_;
  std::map<std::string, std::pair<std::string, std::ptrdiff_t>> told_;  // the first such line, and how many more
};

void convert_file(const ConvertOptions& o) {
  InputFiles inputs = inputs_of(o, {o.in});
  inputs.refuse(o.out);
  const Loaded loaded(o, std::move(inputs));
  std::set<std::string> taken;
  Conversion one(o, loaded, taken);
  const auto tell = [&] { std::printf("%s", one.told().c_str()); };
  try {
    one.run();
  } catch (...) {
    tell();
    throw;
  }
  tell();
}

/// SMPL-H and MANO are downloads apart.
void merge_hands(const ConvertOptions& o) {
  if (kind_of(o.out) != ".npz")
    ml::raise<usage_error>(103, o.out, ": a body is written to .npz, not '", kind_of(o.out), "'");
  InputFiles{o.in, o.hands.at(0), o.hands.at(1)}.refuse(o.out);
  ml::merge_smplh(o.in, o.hands.at(0), o.hands.at(1), o.out);
  std::printf("%s: the body of %s with the hands of %s and %s\n", o.out.c_str(), o.in.c_str(), o.hands[0].c_str(),
              o.hands[1].c_str());
}

void run(ConvertOptions o) {
  if (!o.hands.empty()) return merge_hands(o);
  if (kind_of(o.out) == ".safetensors") return convert_weights(o.in, o.out, o.tensors, ml::parse_dtype(o.store));
  if (is_texts(o.in)) {
    std::printf("%s", convert_texts(o.in, o.out).c_str());
    return;
  }
  const bool folder = fs::is_directory(o.in);
  if (folder ? o.as.empty() : !fs::path(o.out).has_extension()) o.data_set = find_data_set_form(o.features);
  if (folder && o.as.empty() && o.data_set == nullptr)
    throw CLI::ValidationError("input",
                               o.in + " is a folder: say with --as what its files become (.bvh, .glb, .npz, ...)");
  if (!folder && !o.as.empty()) throw CLI::ValidationError("--as", "is for folders; " + o.in + " is a file");
  if (o.as == ".obj" && o.body.file.empty())
    throw CLI::ValidationError("--as", ".obj files show a body: --body says which");
  if (const std::string kind = folder ? o.as : kind_of(o.out);
      !o.skeleton.empty() && (o.data_set != nullptr || kind == ".npz" || kind == ".npy"))
    throw CLI::ValidationError("--skeleton", "is for results on any joints (.bvh, .glb, .html, .svg, .png), not for " +
                                                 (o.data_set != nullptr ? "data sets" : kind));
  if (o.replace && o.data_set == nullptr)
    throw CLI::ValidationError("--replace", "is for clips of a data set (--features guoh3d or kit, into a folder)");
  if (folder) return FolderConversion(o).run();
  o.read.require_for(o.in);
  if (o.data_set == nullptr) require_folder_of(o.out);
  convert_file(o);
}

/// more: what else the input may be.
void add_input(CLI::App& c, ConvertOptions& o, const std::string& more = "") {
  c.add_option("input", o.in,
               "Motion: .bvh (every ROOT), .amc, .npz (AMASS, smplx), .npy (joints, features, or MDM's results.npy: "
               "every motion), .glb, .gltf (with its data in it), .vrm or .vrma (every animation); or a folder of them "
               "(.vrm, mostly avatars, and .gltf are passed over there)" +
                   more)
      ->required()
      ->check(CLI::ExistingPath);
  o.read.add_to(c);
}

CLI::Option* add_body(CLI::App& c, ConvertOptions& o) {
  CLI::Option* body = c.add_option("--body", o.body.file,
                                   "Body to show it on, your own file of SMPL, SMPL-H or SMPL-X: .npz or .pkl; hands "
                                   "and shape of AMASS files are shown, too; \"free\" for capsules")
                          ->check(CLI::ExistingFile | CLI::IsMember({"free"}));
  c.add_option("--betas", o.body.betas,
               "Shape of the body: its first coefficients, separated by commas; that of an AMASS file unless given")
      ->delimiter(',')
      ->needs(body);
  return body;
}

void add_picture(CLI::App& app, const std::string& name, const std::string& about, const std::string& extension) {
  const auto o = std::make_shared<ConvertOptions>();
  CLI::App* c = app.add_subcommand(name, about);
  add_input(*c, *o);
  c->add_option(
      "output,-o,--output", o->out,
      "The result, of a folder the folder of the results; walk.bvh" + extension + " beside walk.bvh unless given");
  c->callback([o, extension] {
    if (fs::is_directory(o->in)) {
      if (o->as.empty()) o->as = extension;
    } else if (o->out.empty()) {
      o->out = beside(o->in, extension).string();
    }
    const std::string kind = kind_of(o->out);
    if (o->as.empty() && kind != extension && !(extension == ".svg" && kind == ".png"))
      throw CLI::ValidationError("output", o->out + " ends in '" + kind + "', not in '" + extension +
                                               (extension == ".svg" ? "' or '.png" : "") + "'; other formats: convert");
    run(*o);
  });
  if (extension == ".html")
    add_body(*c, *o);
  else
    c->add_option("--as", o->as, "Of a folder: what the strips are, .svg unless given")
        ->check(CLI::IsMember({".svg", ".png"}));
}

}  // namespace

void add_convert(CLI::App& app) {
  const auto o = std::make_shared<ConvertOptions>();
  CLI::App* c = app.add_subcommand("convert",
                                   "Reads a motion and writes it in another format, edited if you like; or weights of "
                                   "any kind as .safetensors; or texts of motions");
  add_input(*c, *o,
            "; or weights, or a body (--hands); or texts: .json of BABEL, or annotations as TMR and STMC have them");
  c->add_option(
       "output", o->out,
       "Result: .bvh, .glb, .npz (AMASS, on SMPL's skeleton), .npy (SMPL's joints, Z up as STMC saves them), .html "
       "(page), .svg or .png (film strip), with --body .obj (one for each frame); of weights .safetensors, of "
       "a body (--hands) .npz; of a folder a folder (--as); of texts .json (annotations as TMR and STMC have "
       "them), or a folder for texts/ as HumanML3D has it")
      ->check(not_empty())
      ->required();
  c->add_option("--as", o->as,
                "Of a folder: what the motion files in it and below become, .bvh for instance, with --body also .obj; "
                "the result is a folder, too")
      ->check(CLI::IsMember({".bvh", ".glb", ".npz", ".npy", ".html", ".svg", ".png", ".obj"}));
  const CLI::Option* tensors =
      c->add_option("--tensors", o->tensors,
                    "Of weights: keys to the tensors in the file, for instance state_dict or a/b; found unless given");
  const CLI::Option* store =
      c->add_option("--store", o->store, "Of weights: floating-point numbers rounded to this type")
          ->transform(CLI::IsMember({"F32", "F16", "BF16"}, CLI::ignore_case));
  c->add_option(
       "--fps", o->fps,
       "Frames per second of the result; as the input unless given; of a GLB input whose keys are at no frames 30")
      ->check(positive());
  c->add_option("--from", o->from, "Begin, seconds")->check(not_negative());
  c->add_option("--to", o->to, "End, seconds")->check(positive());
  c->add_option("--speed", o->speed, "How much faster")->check(positive())->capture_default_str();
  c->add_option("--units", o->scale, "Units per metre of a BVH file that is written")
      ->check(positive())
      ->capture_default_str();
  CLI::Option* rig =
      c->add_option("--rig", o->rig.file,
                    "Character (.glb or .vrm with a skin): the result is this file with the motion added")
          ->check(CLI::ExistingFile);
  CLI::Option* body = add_body(*c, *o)->excludes(rig);
  c->add_flag("--drop-animations", o->rig.drop_animations, "Without the animations that the character has already")
      ->needs(rig);
  c->add_option(
       "--skeleton", o->skeleton,
       "Motion file (.bvh in --units, .glb, ...): the result is on its skeleton, with its names, bones and rest pose")
      ->excludes(rig)
      ->excludes(body)
      ->check(CLI::ExistingFile);
  c->add_option("--features", o->features,
                "Writes features to .npy: guoh3d (HumanML3D), kit, rifke (TMR), rifke64 (TEMOS on KIT), smplvelp "
                "(TEMOS, with the exact heading), smplvelp-published (with its own turn), smplrifke (STMC) or actor; "
                "at the rate of the system unless --fps is given. Of guoh3d and kit the result may be a folder: a clip "
                "is added to this data set")
      ->check(features_name())
      ->excludes(rig)
      ->excludes(body);
  c->add_flag("--replace", o->replace,
              "Of a data set: a clip takes the place of another motion that has its name there, whose captions stay");
  CLI::Option* denoise =
      c->add_option("--denoise", o->denoise,
                    "Model (ACTOR, TEMOS, TMR, SINC: of our training or as published) that encodes and decodes the "
                    "motion: what it does not know, noise for instance, is left out; on the joints of the model")
          ->check(CLI::ExistingPath);
  c->add_option("--action", o->action, "Of --denoise with ACTOR: name or number of the action that the motion shows")
      ->needs(denoise);
  c->add_option("--text-encoder", o->sources.text_encoder,
                "Of --denoise with a published TEMOS or SINC: as for generate")
      ->needs(denoise)
      ->check(CLI::ExistingPath);
  c->add_option("--statistics", o->sources.statistics, "Of --denoise with a published model: as for generate")
      ->needs(denoise)
      ->check(CLI::ExistingDirectory);
  c->add_flag("--smpl", o->smpl, "On SMPL's 24 joints");
  c->add_flag("--mirror", o->mirror, "Left becomes right");
  c->add_flag("--smooth", o->smooth, "Without trembling");
  c->add_flag("--in-place", o->in_place, "The root stays over the origin");
  c->add_option("--loop", o->loop, "Makes a loop: so many seconds at the end are blended into the start")
      ->check(positive());
  c->add_flag(
      "--fix-feet", o->fix_feet,
      "On SMPL's 24 joints, and feet that stand do not slide: the path over the floor becomes what the feet say, "
      "a tenth shorter for some recorded runs");
  const CLI::Option* hands =
      c->add_option("--hands", o->hands,
                    "Of a body of SMPL-H: MANO_LEFT.pkl and MANO_RIGHT.pkl, whose hands go into the result with it")
          ->expected(2)
          ->check(CLI::ExistingFile);
  c->callback([o, c, hands, tensors, store] {
    const bool weights = kind_of(o->out) == ".safetensors";
    for (const CLI::Option* option : c->get_options()) {  // not by excludes, which --help would say at every option
      if (!option->nonpositional() || option->count() == 0) continue;
      if (is_texts(o->in) && !weights)
        throw CLI::ValidationError(option->get_name(), "is not for texts of motions, as in " + o->in);
      if (!o->hands.empty() && option != hands) throw CLI::ExcludesError(hands->get_name(), option->get_name());
      if ((option == tensors || option == store) != weights && option != hands)
        throw CLI::ValidationError(option->get_name(),
                                   ml::concat_text(weights ? "is not" : "is",
                                                   " for weights, written as .safetensors; the result is ", o->out));
    }
    if (!o->rig.file.empty()) o->rig.joints = std::exchange(o->read.joints, {});
    if (o->fps > 0) o->read.fps = o->fps;  // GLB keys are sampled where they are wanted
    run(*o);
  });
  add_picture(app, "strip", "Draws a film strip (SVG or PNG) of a motion", ".svg");
  add_picture(app, "view", "Writes a page (HTML) on which a motion can be watched", ".html");
}

}  // namespace program
