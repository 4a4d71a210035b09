// Ctrl-C.
#include <doctest/doctest.h>

#include <algorithm>

#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/features/motion_features.hpp>

#include "../support/captioned_clips.hpp"
#include "small_workplace.hpp"

TEST_CASE("Ctrl-C while generating: 130, and no file") {
  const Workplace w(1000);
  ml::write_file(w / "long.txt", "walk forward # 0 # 45 # legs\n");
  const auto stopped = w.generate("out", {}, "long.txt", "generating");
  CHECK(stopped.code == 130);
  CHECK_MESSAGE(contains(stopped.text, "stopped"), stopped.text);
  CHECK(w.files("out").empty());
}

TEST_CASE("Ctrl-C while training: 130 and a checkpoint, from which the same command goes on") {
  const captioned::Clips clips;
  auto train = [&](const std::string& steps, const std::string& interrupt_at = "") {
    return run({"train",
                "--data",
                ".",
                "--captions",
                "captions.tsv",
                "--out",
                "run",
                "--steps",
                steps,
                "--batch",
                "2",
                "--width",
                "16",
                "--feed-forward",
                "24",
                "--layers",
                "1",
                "--vocabulary",
                "40",
                "--text-steps",
                "5"},
               clips.folder.path, interrupt_at);
  };
  const auto stopped = train("5000", "training [");
  CHECK_MESSAGE(stopped.code == 130, stopped.text);
  CHECK(contains(stopped.text, "the same command continues from run/checkpoint.safetensors"));
  const auto names = [&] {
    std::vector<std::string> out;
    for (const auto& f : std::filesystem::directory_iterator(clips.folder / "run")) out.push_back(f.path().filename());
    std::sort(out.begin(), out.end());
    return out;
  };
  CHECK(names() == std::vector<std::string>{"checkpoint.safetensors", "loss.svg"});
  const auto whole = train("20");
  REQUIRE_MESSAGE(whole.code == 0, whole.text);
  CHECK(contains(whole.text, "continuing at step"));
  CHECK(names() == std::vector<std::string>{"checkpoint.safetensors", "loss.svg", "stmc.safetensors"});
  CHECK(run({"info", "run/stmc.safetensors"}, clips.folder.path).code == 0);
  const auto made = run({"generate", "--model", "run/stmc.safetensors", "--text", "Someone blorps a floop", "--seconds",
                         "1", "--preset", "fast", "--out", "made"},
                        clips.folder.path);
  CHECK_MESSAGE(made.code == 0, made.text);
  CHECK_MESSAGE(contains(made.text, "the model never learned the words 'blorps', 'floop'\n"), made.text);
  CHECK_MESSAGE(contains(made.text, "'Someone blorps a floop' is far from all that the model learned"), made.text);
}
