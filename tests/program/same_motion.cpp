// The program, the library's generate_motion, the C functions and the README's code make the same motion: the same
// bytes of BVH for every option that they share.
#include <doctest/doctest.h>

#include <functional>
#include <set>

#include <motionlang/c/motionlang_c.h>
#include <motionlang/compose/text_timeline.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/stmc.hpp>
#include <motionlang/weights/known_caption_file.hpp>
#include <motionlang/weights/module_file.hpp>

#include "../support/temporary_folder.hpp"
#include "process.hpp"
#include "readme_code.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;
using B = ml::EigenBackend<float>;

namespace {

const fs::path examples = MOTIONLANG_EXAMPLES;
const std::string model_file = (examples / "models/stmc_free.safetensors").string();

const char* const texts =
    "walk forward # 0.0 # 2.0 # legs\n"
    "raise both arms # 0.5 # 1.5 # left arm # right arm\n";
const char* const edited =
    "walk forward # 0.0 # 2.0 # legs\n"
    "raise the right arm # 0.5 # 1.5 # right arm\n";

const ml::Stmc<B>& stmc() {
  static const auto model = ml::load_stmc<B>(model_file);
  return model;
}
const motionlang_model* c_model() {
  static const std::unique_ptr<motionlang_model, void (*)(motionlang_model*)> model{
      [] {
        motionlang_model* m = nullptr;
        REQUIRE(motionlang_load_model(model_file.c_str(), &m) == 0);
        return m;
      }(),
      motionlang_free_model};
  return model.get();
}

/// A folder in which all three work. Each of them returns the text of its BVH file.
struct Workplace : TemporaryFolder {
  Workplace() {
    ml::write_file(*this / "texts.txt", std::string_view(texts));
    ml::write_file(*this / "edited.txt", std::string_view(edited));
  }

  std::string by_program(std::vector<std::string> arguments, const std::string& timeline = "texts") const {
    arguments.insert(arguments.begin(),
                     {"generate", "--timeline", timeline + ".txt", "--model", model_file, "--out", "by_program"});
    const Outcome out = run(arguments, path);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    return ml::read_file(*this / ("by_program/" + timeline + ".bvh"));
  }
  std::string by_library(const ml::GenerateOptions& options, const char* timeline = texts) const {
    ml::write_bvh(*this / "by_library.bvh", ml::generate_motion(stmc(), ml::parse_timeline(timeline), options));
    return ml::read_file(*this / "by_library.bvh");
  }
  std::string by_c(const motionlang_options& options, const char* timeline = texts) const {
    motionlang_motion* motion = nullptr;
    const int status = motionlang_generate(c_model(), timeline, &options, &motion);
    REQUIRE_MESSAGE(status == 0, motionlang_message());
    const std::string file = (*this / "by_c.bvh").string();
    CHECK(motionlang_write_motion(motion, file.c_str()) == 0);
    motionlang_free_motion(motion);
    return ml::read_file(file);
  }
};

/// One set of options, as each of the three has it.
struct Choice {
  std::vector<std::string> arguments;
  std::function<void(ml::GenerateOptions&)> library;
  std::function<void(motionlang_options&)> c;
};

const std::vector<Choice> choices{
    {{}, [](ml::GenerateOptions&) {}, [](motionlang_options&) {}},
    {{"--seed", "12345678901"},
     [](ml::GenerateOptions& o) { o.seed = 12345678901; },
     [](motionlang_options& o) { o.seed = 12345678901; }},
    {{"--steps", "5"}, [](ml::GenerateOptions& o) { o.steps = 5; }, [](motionlang_options& o) { o.steps = 5; }},
    {{"--steps", "5", "--sampler", "ddim"},
     [](ml::GenerateOptions& o) { o.steps = 5, o.sampler = ml::SamplingOptions::Sampler::ddim; },
     [](motionlang_options& o) { o.steps = 5, o.sampler = "ddim"; }},
    {{"--preset", "fast"},
     [](ml::GenerateOptions& o) { ml::use_fast_preset(o); },
     [](motionlang_options& o) { o.steps = 10, o.sampler = "ddim"; }},
    {{"--preset", "full"},
     [](ml::GenerateOptions& o) { ml::use_full_preset(o); },
     [](motionlang_options& o) { o.all_steps = 1, o.sampler = "ddpm"; }},
    {{"--steps", "5", "--guidance", "1.5"},
     [](ml::GenerateOptions& o) { o.steps = 5, o.guidance = 1.5; },
     [](motionlang_options& o) { o.steps = 5, o.guidance = 1.5; }},
    {{"--steps", "5", "--overlap", "0.2"},
     [](ml::GenerateOptions& o) { o.steps = 5, o.overlap = 0.2; },
     [](motionlang_options& o) { o.steps = 5, o.overlap = 0.2; }},
    {{"--steps", "5", "--mode", "sinc-lerp"},
     [](ml::GenerateOptions& o) { o.steps = 5, o.mode = ml::StmcMode::sinc_lerp; },
     [](motionlang_options& o) { o.steps = 5, o.mode = "sinc-lerp"; }},
    {{"--steps", "5", "--no-cut-texts"},
     [](ml::GenerateOptions& o) { o.steps = 5, o.cut_texts = false; },
     [](motionlang_options& o) { o.steps = 5, o.cut_texts = 0; }},
    {{"--steps", "5", "--no-smooth"},
     [](ml::GenerateOptions& o) { o.steps = 5, o.smooth = false; },
     [](motionlang_options& o) { o.steps = 5, o.smooth = 0; }},
    {{"--steps", "5", "--no-fix-feet"},
     [](ml::GenerateOptions& o) { o.steps = 5, o.fix_feet = false; },
     [](motionlang_options& o) { o.steps = 5, o.fix_feet = 0; }},
    {{"--steps", "2", "--no-fix-floor"},
     [](ml::GenerateOptions& o) { o.steps = 2, o.fix_floor = false; },
     [](motionlang_options& o) { o.steps = 2, o.fix_floor = 0; }},
    {{"--steps", "2", "--overlay-arms"},
     [](ml::GenerateOptions& o) { o.steps = 2, o.overlay_arms = true; },
     [](motionlang_options& o) { o.steps = 2, o.overlay_arms = 1; }},
};

}  // namespace

TEST_CASE("every option of a motion gives the same bytes in the program, the library and the C functions") {
  const Workplace w;
  std::set<std::string> different;
  for (const Choice& choice : choices) {
    CAPTURE(ml::join_text(choice.arguments, " "));
    ml::GenerateOptions options;
    choice.library(options);
    motionlang_options c_options = motionlang_default_options();
    choice.c(c_options);
    const std::string program = w.by_program(choice.arguments);
    CHECK(w.by_library(options) == program);
    CHECK(w.by_c(c_options) == program);
    different.insert(program);
  }
  CHECK(different.size() == choices.size());  // no option is skipped
}

TEST_CASE("noise from a file, records and what is reused of them") {
  const Workplace w;
  ml::TensorStore store;
  const ml::Shape shape{1, 40, 205};
  for (int draw = 0; draw <= 3; ++draw) {
    const auto z = stmc().noise({.seed = 4}, draw, shape);
    store.add<float>("noise/00" + std::to_string(draw), shape, z.span(), ml::DType::F32);
  }
  const std::string noise = (w / "noise.safetensors").string();
  ml::write_safetensors(noise, store.views());
  motionlang_options c = motionlang_default_options();
  c.steps = 3, c.noise = noise.c_str();
  const std::string with_noise = w.by_program({"--steps", "3", "--noise", noise});
  CHECK(w.by_library({.steps = 3, .noise = noise}) == with_noise);
  CHECK(w.by_c(c) == with_noise);
  CHECK(w.by_library({.seed = 4, .steps = 3}) == with_noise);

  const std::string record = (w / "by_program/texts.steps.safetensors").string(),
                    own = (w / "own.steps.safetensors").string(), of_c = (w / "c.steps.safetensors").string();
  w.by_program({"--steps", "3", "--seed", "9", "--record"});
  const std::string recorded = ml::read_file(record);
  w.by_library({.seed = 9, .steps = 3, .record = own});
  CHECK(ml::read_file(own) == recorded);
  c = motionlang_default_options();
  c.seed = 9, c.steps = 3, c.record = of_c.c_str();
  w.by_c(c);
  CHECK(ml::read_file(of_c) == recorded);

  c = motionlang_default_options();
  c.reuse = own.c_str();
  const std::string again = w.by_program({"--reuse", own}, "edited");
  CHECK(w.by_library({.reuse = own}, edited) == again);
  CHECK(w.by_c(c, edited) == again);
  c.keep_beyond = 0.1;
  const std::string nearer = w.by_program({"--reuse", own, "--keep-beyond", "0.1"}, "edited");
  CHECK(nearer != again);
  CHECK(w.by_library({.reuse = own, .keep_beyond = 0.1}, edited) == nearer);
  CHECK(w.by_c(c, edited) == nearer);
}

TEST_CASE("a motion of which something is kept") {
  const Workplace w;
  ml::write_file(w / "clip.bvh", w.by_program({"--steps", "3", "--seed", "2"}));
  const std::string clip = (w / "clip.bvh").string();
  motionlang_motion* read = nullptr;
  REQUIRE(motionlang_read_motion(clip.c_str(), &read) == 0);
  const ml::Motion motion = ml::read_bvh_motion(clip);
  const double seconds[] = {0, 0.4, 1.5, 2};

  motionlang_options c = motionlang_default_options();
  c.steps = 3, c.keep = read, c.keep_seconds = seconds, c.keep_stretches = 2;
  const std::string around = w.by_program({"--steps", "3", "--keep", clip, "--keep-seconds", "0-0.4,1.5-2"});
  CHECK(w.by_library({.steps = 3, .keep = ml::KeptClip{motion, {{0, 0.4}, {1.5, 2}}}}) == around);
  CHECK(w.by_c(c) == around);

  c.keep_stretches = 0, c.keep_parts = "legs, head";
  const std::string steps = w.by_program({"--steps", "3", "--keep", clip, "--keep-parts", "legs,head"});
  const auto parts = ml::BodyParts{}.with(ml::BodyPart::legs).with(ml::BodyPart::head);
  CHECK(w.by_library({.steps = 3, .keep = ml::KeptClip{motion, {}, parts}}) == steps);
  CHECK(w.by_c(c) == steps);
  CHECK(steps != around);

  motionlang_motion* none = nullptr;
  c.keep_parts = "tail";
  CHECK(motionlang_generate(c_model(), texts, &c, &none) == 103);
  CHECK(std::string(motionlang_message()).find("'tail' is not one of left arm") != std::string::npos);
  c.keep_parts = nullptr, c.keep_stretches = -1;
  CHECK(motionlang_generate(c_model(), texts, &c, &none) == 101);
  c.keep_stretches = 1, c.keep_seconds = nullptr;
  CHECK(motionlang_generate(c_model(), texts, &c, &none) == 101);
  c.keep_seconds = seconds + 1;  // 0.4 to 1.5, but the noise is given as well
  c.noise = "noise.safetensors";
  CHECK(motionlang_generate(c_model(), texts, &c, &none) == 102);
  CHECK(none == nullptr);
  motionlang_free_motion(read);
}

TEST_CASE("a text without times, and one that is longer than its action") {
  const Workplace w;
  const auto captions = ml::load_known_captions(ml::FilePath(model_file), stmc().text_encoder);
  std::set<std::string> different;
  for (const double seconds : {0.0, 3.0, 9.0}) {
    CAPTURE(seconds);
    std::vector<std::string> arguments{"generate", "--text",   "sit down", "--steps", "3",
                                       "--model",  model_file, "--out",    "of_text"};
    ml::TextTimelineOptions times{.fps = stmc().fps};
    if (seconds > 0) times.seconds = seconds, arguments.insert(arguments.end(), {"--seconds", std::to_string(seconds)});
    const Outcome out = run(arguments, w.path);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    const std::string program = ml::read_file(w / "of_text/sit_down.bvh");
    ml::write_bvh(w / "by_library.bvh",
                  ml::generate_motion(stmc(), ml::text_timeline("sit down", captions, times), {.steps = 3}));
    CHECK(ml::read_file(w / "by_library.bvh") == program);
    motionlang_options c = motionlang_default_options();
    c.steps = 3;
    motionlang_motion* motion = nullptr;
    REQUIRE(motionlang_generate_text(c_model(), "sit down", seconds, &c, &motion) == 0);
    CHECK(motionlang_write_motion(motion, (w / "by_c.bvh").string().c_str()) == 0);
    motionlang_free_motion(motion);
    CHECK(ml::read_file(w / "by_c.bvh") == program);
    different.insert(program);
  }
  CHECK(different.size() == 3);
  motionlang_motion* none = nullptr;
  CHECK(motionlang_generate_text(c_model(), "", 1, nullptr, &none) == 101);
  CHECK(motionlang_generate_text(c_model(), "walk", -1, nullptr, &none) == 101);
  CHECK(motionlang_generate_text(c_model(), nullptr, 1, nullptr, &none) == 101);
}

TEST_CASE("the README's code writes what the program writes") {
  const Workplace w;
  fs::create_directory_symlink(examples, w / "examples");
  const fs::path before = fs::current_path();
  fs::current_path(w.path);
  readme_code();
  fs::current_path(before);
  fs::copy_file(examples / "timelines/walk_and_raise_arms.txt", w / "walk.txt");
  CHECK(ml::read_file(w / "walk.bvh") == w.by_program({"--seed", "7"}, "walk"));
}
