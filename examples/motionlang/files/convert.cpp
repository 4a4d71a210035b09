// motionlang convert, strip, view: a file of motion in, another file, a picture or a page out.
#include <cstdio>
#include <utility>

#include <motionlang/datasets/annotated_texts.hpp>
#include <motionlang/formats/merged_body.hpp>
#include <motionlang/view/convert_motions.hpp>
#include <motionlang/weights/describe_weights.hpp>
#include <motionlang/weights/safetensors_copy.hpp>

#include "../commands.hpp"
#include "../formatted.hpp"
#include "../generate/generation.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"
#include "motion_files.hpp"

namespace program {

namespace {

namespace fs = std::filesystem;

struct ConvertOptions {
  std::string in, out;  // out: "" for a folder: beside each motion
  std::string tensors, store, features;
  std::string denoise, action;            // a model, and the action that the motion shows
  ml::ModelSources sources;               // of this model
  std::string as;                         // for a folder: the extension of the results
  std::string skeleton;                   // a motion whose skeleton the result takes
  std::vector<std::string> hands;         // left, right: files of MANO to merge into a file of SMPL-H
  const DataSetForm* data_set = nullptr;  // form of the folder for the clips
  MotionReadOptions read;
  ml::RigOptions rig;
  ml::ShownBodyOptions body;
  ml::TimeEdits time;
  ml::MotionEdits edits;
  bool one_euro = false;
  ml::OneEuroOptions filter;
  double scale = 100;
  bool replace = false;  // clips of the data set
};

/// The function that --denoise applies to a motion; empty without --denoise. Loads the model at once.
std::function<ml::Motion(const ml::Motion&)> denoiser_of(const ConvertOptions& o) {
  if (o.denoise.empty()) return {};
  const std::shared_ptr<const ml::MotionModel> generator = load_generator("eigen", o.denoise, o.sources);
  const ml::LatentMotionModel& model = require_latent(*generator, "--denoise", o.denoise);
  if (model.takes_actions() && o.action.empty())
    ml::raise<usage_error>(102, "ACTOR needs to know which action the motion shows: name it with --action");
  if (!model.takes_actions() && !o.action.empty())
    ml::raise<usage_error>(102, "--action '", o.action, "' is for ACTOR; this model needs no action");
  return [generator, &model, action = o.action](const ml::Motion& m) { return model.denoised(m, action); };
}

/// The files that the options name, other than motions.
ml::InputFiles inputs_of(const ConvertOptions& o) {
  return {o.rig.file, o.rig.joints, o.body.file == "free" ? "" : o.body.file, o.skeleton, o.read.joints, o.read.asf};
}
/// Reads the files that the options name. `body` must outlive the result.
ml::MotionConversion conversion_of(const ConvertOptions& o, const ml::ShownBody* body) {
  ml::MotionConversion out{.read = o.read,
                           .time = o.time,
                           .edits = o.edits,
                           .rig = ml::rig_writer(o.rig),
                           .body = body,
                           .features = o.features,
                           .data_set = o.data_set,
                           .replace = o.replace,
                           .scale = o.scale,
                           .inputs = inputs_of(o)};
  if (o.one_euro) out.edits.one_euro = o.filter;
  out.denoise = denoiser_of(o);
  if (!o.skeleton.empty()) out.skeleton = read_motions(o.skeleton, {.scale = 1 / o.scale}).front().skeleton;
  return out;
}

void say(const ml::FolderConversion& made, const ConvertOptions& o) {
  for (const std::string& f : made.failures) std::fprintf(stderr, "%s\n", with_options(f).c_str());
  for (const auto& [about, said] : made.notes) {
    const auto& [first, more] = said;
    std::printf("%s%s\n", with_options(first).c_str(), more > 0 ? formatted(" (and of %td more)", more).c_str() : "");
  }
  std::printf("%s: %zu of %s converted\n", (o.out.empty() ? o.in : o.out).c_str(), made.converted,
              counted(made.files, "file").c_str());
}

void convert_folder(const ConvertOptions& o) {
  std::string skipped;
  const auto files = ml::files_to_convert(o.in, o.out, o.data_set != nullptr ? ".npy" : o.as, &skipped);
  std::fputs(skipped.c_str(), stderr);
  const auto body = shown_body(o.body);
  ml::FolderConversion made;
  try {
    ProgressBar bar("converting");
    ml::convert_files(files, o.in, o.out, o.as, conversion_of(o, body.get()), made, bar);
  } catch (const ml::cancelled&) {}
  say(made, o);
  if (made.done < made.files) throw ml::cancelled();
  if (!made.failures.empty())
    ml::raise<ml::config_error>(101, "convert: ", made.failures.size(), " of the ", ml::counted(made.files, "file"),
                                " of ", o.in, " could not be converted");
}

void convert_file(const ConvertOptions& o) {
  ml::InputFiles inputs = inputs_of(o);
  inputs.add(o.in);
  inputs.refuse(o.out);
  const auto body = shown_body(o.body);
  ml::MotionConversion how = conversion_of(o, body.get());
  how.inputs = std::move(inputs);
  ml::ConversionNotes notes;
  const auto tell = [&] { std::printf("%s%s", with_options(notes.input).c_str(), notes.results.c_str()); };
  try {
    ml::convert_motions(o.in, o.out, how, &notes);
  } catch (...) {
    tell();
    throw;
  }
  tell();
}

/// SMPL-H and MANO are separate downloads.
void merge_hands(const ConvertOptions& o) {
  if (kind_of(o.out) != ".npz")
    ml::raise<usage_error>(103, o.out, ": a body is written to .npz, not '", kind_of(o.out), "'");
  ml::InputFiles{o.in, o.hands.at(0), o.hands.at(1)}.refuse(o.out);
  ml::merge_smplh(o.in, o.hands.at(0), o.hands.at(1), o.out);
  std::printf("%s: the body of %s with the hands of %s and %s\n", o.out.c_str(), o.in.c_str(), o.hands[0].c_str(),
              o.hands[1].c_str());
}

/// True if the file holds texts of motions rather than motions.
bool is_texts(const std::string& path) { return kind_of(path) == ".json"; }

void convert_weights(const ConvertOptions& o) {
  ml::WeightOptions options;
  if (!o.tensors.empty()) options.path = o.tensors;
  const auto weights = ml::open_weights(o.in, options);
  ml::InputFiles(weights.files()).refuse(o.out);
  ml::write_safetensors_copy(o.out, weights, ml::parse_dtype(o.store));
  std::printf("%s: %s\n%s", o.out.c_str(), ml::line_about_weights(ml::open_weights(o.out)).c_str(),
              ml::lines_about_skipped(weights).c_str());
}

void run(ConvertOptions o) {
  if (!o.hands.empty()) return merge_hands(o);
  if (kind_of(o.out) == ".safetensors") return convert_weights(o);
  if (is_texts(o.in)) return print(ml::convert_texts(o.in, o.out));
  const bool folder = fs::is_directory(o.in);
  if (folder ? o.as.empty() : !fs::path(o.out).has_extension()) o.data_set = find_data_set_form(o.features);
  if (folder && o.as.empty() && o.data_set == nullptr)
    throw CLI::ValidationError("input",
                               o.in + " is a folder: --as names the format of the results (.bvh, .glb, .npz, ...)");
  if (!folder && !o.as.empty()) throw CLI::ValidationError("--as", "is for folders; " + o.in + " is a file");
  if (o.as == ".obj" && o.body.file.empty())
    throw CLI::ValidationError("--as", ".obj files show a body: name it with --body");
  if (const std::string kind = folder ? o.as : kind_of(o.out);
      !o.skeleton.empty() && (o.data_set != nullptr || kind == ".npz" || kind == ".npy"))
    throw CLI::ValidationError("--skeleton", "is for results on any joints (.bvh, .glb, .html, .svg, .png), not for " +
                                                 (o.data_set != nullptr ? "data sets" : kind));
  if (o.replace && o.data_set == nullptr)
    throw CLI::ValidationError("--replace", "is for clips of a data set (--features guoh3d or kit, into a folder)");
  if (folder) return convert_folder(o);
  o.read.require_for(o.in);
  if (o.data_set == nullptr) require_folder_of(o.out);
  convert_file(o);
}

/// more: further kinds of input.
void add_input(CLI::App& c, ConvertOptions& o, const std::string& more = "") {
  path_option(c, "input", o.in,
              "Motion file: .bvh (every ROOT), .amc, .npz (AMASS, smplx), .npy (joints, features, or every motion of "
              "MDM's results.npy), .glb, .gltf with embedded data, .vrm or .vrma (every animation). Or a folder of "
              "them, where .vrm and .gltf are skipped" +
                  more)
      ->required();
  o.read.add_to(c);
}

CLI::Option* add_body(CLI::App& c, ConvertOptions& o) {
  CLI::Option* body = c.add_option("--body", o.body.file,
                                   "Body that shows the motion: your own file of SMPL, SMPL-H or SMPL-X (.npz or "
                                   ".pkl), or \"free\" for capsules. Hands and shape of AMASS files are shown too")
                          ->check(CLI::ExistingFile | CLI::IsMember({"free"}));
  c.add_option("--betas", o.body.betas,
               "First shape coefficients of the body, separated by commas. The default is the shape in an AMASS file")
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
      "Result; for a folder, the folder of the results. The default is walk.bvh" + extension + " beside walk.bvh");
  c->callback([o, extension] {
    if (fs::is_directory(o->in)) {
      if (o->as.empty()) o->as = extension;
    } else if (o->out.empty()) {
      o->out = ml::beside_motion(o->in, extension).string();
    }
    if (!o->rig.file.empty()) o->rig.joints = std::exchange(o->read.joints, {});
    const std::string kind = kind_of(o->out);
    if (o->as.empty() && kind != extension && !(extension == ".svg" && kind == ".png"))
      throw CLI::ValidationError("output", o->out + " ends in '" + kind + "', not in '" + extension +
                                               (extension == ".svg" ? "' or '.png" : "") + "'; other formats: convert");
    run(*o);
  });
  if (extension == ".html") {
    CLI::Option* body = add_body(*c, *o);
    file_option(*c, "--rig", o->rig.file, "Character (.glb or .vrm with a skin) that shows the motion, in one colour")
        ->excludes(body);
  } else {
    c->add_option("--as", o->as, "Format of the results of a folder. The default is .svg")
        ->check(CLI::IsMember({".svg", ".png"}));
  }
}

}  // namespace

void add_convert(CLI::App& app) {
  const auto o = std::make_shared<ConvertOptions>();
  CLI::App* c = app.add_subcommand(
      "convert",
      "Converts a motion to another format and edits it. Also converts weights to .safetensors, and texts of motions");
  add_input(*c, *o,
            ". Also weights, a body (--hands), or texts (.json of BABEL, or annotations as TMR and STMC have them)");
  c->add_option(
       "output", o->out,
       "Result: .bvh, .glb, .vrma, .npz (AMASS, on SMPL's skeleton), .npy (SMPL's joints, Z up as STMC saves them), "
       ".html (page), .svg or .png (film strip), or with --body .obj (one file per frame). Weights become "
       ".safetensors, a body (--hands) becomes .npz, and a folder becomes a folder (--as). Texts become .json "
       "(annotations as TMR and STMC have them), or a folder with texts/ as HumanML3D has it")
      ->check(not_empty())
      ->required();
  c->add_option("--as", o->as,
                "Format of the motion files in a folder and below, such as .bvh, or .obj with --body. The result is a "
                "folder too")
      ->check(CLI::IsMember({".bvh", ".glb", ".npz", ".npy", ".html", ".svg", ".png", ".obj"}));
  const CLI::Option* tensors =
      c->add_option("--tensors", o->tensors,
                    "Weights: path to the tensors in the file, such as state_dict or a/b. The default is to find it");
  const CLI::Option* store =
      c->add_option("--store", o->store,
                    "Weights: type to which floating-point values are rounded. I8: matrices become whole numbers of "
                    "8 bits with a scale for 64 columns of a row")
          ->transform(CLI::IsMember({"F32", "F16", "BF16", "I8"}, CLI::ignore_case));
  c->add_option("--fps", o->time.fps,
                "Frames per second of the result. The default is the rate of the input, or 30 for a GLB file whose "
                "keys follow no frame rate")
      ->check(positive());
  c->add_option("--from", o->time.from, "Start in seconds")->check(not_negative());
  c->add_option("--to", o->time.to, "End in seconds")->check(positive());
  checked_option(*c, "--speed", o->time.speed, positive(), "Factor by which the motion becomes faster");
  checked_option(*c, "--units", o->scale, positive(), "Units per metre of a BVH result");
  CLI::Option* rig =
      file_option(*c, "--rig", o->rig.file,
                  "Character (.glb or .vrm with a skin). A .glb result is this file with the motion added, an .html "
                  "result is a page that shows it in one colour");
  CLI::Option* body = add_body(*c, *o)->excludes(rig);
  c->add_flag("--drop-animations", o->rig.drop_animations, "Leave out the animations that the character already has")
      ->needs(rig);
  c->add_option("--skeleton", o->skeleton,
                "Motion file (.bvh in --units, .glb, ...) whose skeleton the result takes: names, bones and rest pose")
      ->excludes(rig)
      ->excludes(body)
      ->check(CLI::ExistingFile);
  c->add_option(
       "--features", o->features,
       "Write features to .npy: guoh3d (HumanML3D), kit, rifke (TMR), rifke64 (TEMOS on KIT), smplvelp (TEMOS, exact "
       "heading), smplvelp-published (TEMOS, published heading), smplrifke (STMC) or actor. The default rate is that "
       "of the system. With guoh3d or kit the result may be a folder: the clip is added to this data set")
      ->check(features_name())
      ->excludes(rig)
      ->excludes(body);
  c->add_flag("--replace", o->replace, "A clip replaces the clip of the same name in the data set. Its captions stay");
  CLI::Option* denoise =
      path_option(*c, "--denoise", o->denoise,
                  "Model that encodes and decodes the motion: ACTOR, TEMOS, TMR or SINC, trained here or published. "
                  "The result lacks what the model never learned, such as noise, and is on the model's joints");
  c->add_option("--action", o->action, "Action that the motion shows, by name or number, for --denoise with ACTOR")
      ->needs(denoise);
  c->add_option("--text-encoder", o->sources.text_encoder,
                "Text encoder for --denoise with a published TEMOS or SINC, as for generate")
      ->needs(denoise)
      ->check(CLI::ExistingPath);
  c->add_option("--statistics", o->sources.statistics,
                "Statistics for --denoise with a published model, as for generate")
      ->needs(denoise)
      ->check(CLI::ExistingDirectory);
  c->add_flag("--smpl", o->edits.smpl, "Retarget to SMPL's 24 joints");
  c->add_flag("--mirror", o->edits.mirror, "Exchange left and right");
  c->add_flag("--smooth", o->edits.smooth, "Remove jitter");
  CLI::Option* one_euro = c->add_flag("--one-euro", o->one_euro,
                                      "Remove jitter by the 1 euro filter, which does not look ahead. Fast movements "
                                      "lag a little");
  checked_option(*c, "--one-euro-cutoff", o->filter.min_cutoff, positive(),
                 "Cutoff of the 1 euro filter for what does not move, Hz")
      ->needs(one_euro);
  checked_option(*c, "--one-euro-beta", o->filter.beta, not_negative(),
                 "By how much speed raises this cutoff, Hz per metre (or radian) and second")
      ->needs(one_euro);
  c->add_flag("--in-place", o->edits.in_place, "Keep the root over the origin");
  c->add_option("--loop", o->edits.loop, "Make a loop by blending this many seconds at the end into the start")
      ->check(positive());
  c->add_flag("--fix-feet", o->edits.fix_feet,
              "Retarget to SMPL's 24 joints and keep standing feet from sliding. The path over the floor then follows "
              "the feet, and becomes a tenth shorter for some recorded runs");
  const CLI::Option* hands =
      c->add_option("--hands", o->hands,
                    "Files MANO_LEFT.pkl and MANO_RIGHT.pkl, whose hands are merged into an SMPL-H body")
          ->expected(2)
          ->check(CLI::ExistingFile);
  c->callback([o, c, hands, tensors, store] {
    const bool weights = kind_of(o->out) == ".safetensors";
    for (const CLI::Option* option : c->get_options()) {  // not by excludes, which --help would print at every option
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
    if (o->time.fps > 0) o->read.fps = o->time.fps;  // samples GLB keys at the wanted times
    run(*o);
  });
  add_picture(app, "strip", "Draws a film strip (SVG or PNG) of a motion or of a folder of motions", ".svg");
  add_picture(app, "view", "Writes an HTML page that shows a motion, or one for each motion of a folder", ".html");
}

}  // namespace program
