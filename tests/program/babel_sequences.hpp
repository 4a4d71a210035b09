// SPDX-License-Identifier: MIT
/// Made-up sequences in the form of AMASS with labels in that of BABEL, and small trainings on them.
#pragma once

#include <motionlang/file/id_list.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/formats/amass.hpp>

#include "../support/synthetic_motion.hpp"
#include "../support/temporary_folder.hpp"
#include "process.hpp"

namespace ml = motionlang;

/// Sequences 1 to 5 of eight seconds: a T-pose, a walk with a wave in it, a turn, a transition, a person who sits down.
/// Sequence 6 is one action.
struct Sequences : TemporaryFolder {
  Sequences() {
    std::filesystem::create_directories(*this / "CMU/01");
    std::string entries;
    for (int i = 1; i <= 6; ++i) entries += (i == 1 ? "" : ",") + entry(i);
    ml::write_file(*this / "babel.json", "{" + entries + "}");
    ml::write_file(*this / "train.json", "{" + entry(1) + "," + entry(6) + "}");
    ml::write_file(*this / "val.json", "{" + entry(2) + "}");
    std::filesystem::create_directories(*this / "splits");
    const auto list = [&](const char* name, const std::vector<std::string>& ids) {
      ml::write_ids((*this / ("splits/" + std::string(name) + ".txt")).string(), ids);
    };
    list("train", {"1", "2", "3", "6"}), list("val", {"4"}), list("test", {"5"});
    ml::write_file(*this / "parts.json", R"({"walk": ["", "", "Answer: right leg\nleft leg\nbuttocks"],
      "wave": ["", "", "Answer: right arm"], "turn": ["", "", "torso"], "stand still": ["", "", "Answer: neck"],
      "sit down": ["", "", "right leg\nleft leg\nbuttocks\nwaist"]})");
  }

  std::string entry(int i) const {
    const std::string id = std::to_string(i), name = "01/0" + id + "_poses";
    ml::write_amass(*this / ("CMU/" + name + ".npz"), synthetic::walk({.frames = 480, .fps = 60, .turn = 0.1 * i}));
    const std::string frames = annotation(label("t-pose", R"(, "start_t": 0, "end_t": 0.5)") + "," +
                                          label("wlak", R"(, "start_t": 0.5, "end_t": 3)") + "," +
                                          label("wave", R"(, "start_t": 1, "end_t": 2.5)") + "," +
                                          label("turn", R"(, "start_t": 2.8, "end_t": 5.5)") + "," +
                                          label("transition", R"(, "start_t": 5.4, "end_t": 6.2)") + "," +
                                          label("sit down", R"(, "start_t": 6, "end_t": 8.003)"));
    ml::write_file(*this / "spelling.json", R"({"wlak": "walk"})");
    return "\"" + id + R"(": {"babel_sid": )" + id + R"(, "url": "", "feat_p": "CMU/CMU/)" + name +
           R"(.npz", "dur": 8.0, "seq_ann": )" + annotation(label("stand still")) + R"(, "frame_ann": )" +
           (i == 6 ? "null" : frames) + "}";
  }

  static std::string label(const std::string& text, const std::string& times = "") {
    return R"({"raw_label": "", "proc_label": ")" + text + R"(", "seg_id": "", "act_cat": null)" + times + "}";
  }
  static std::string annotation(const std::string& labels) { return R"({"labels": [)" + labels + "]}"; }

  /// A tiny network.
  Outcome train(const std::string& command, const std::string& out, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{command, "--data", ".",          "--preset",     "small",
                                       "--out", out,      "--spelling", "spelling.json"};
    for (const char* a : {"optimiser.batch=4", "optimiser.schedule=constant", "optimiser.lr=0.01", "optimiser.epochs=2",
                          "network.latent_dim=8", "network.ff_size=8", "network.num_layers=1", "network.num_heads=2",
                          "text.width=8", "text.vocabulary=60"})
      arguments.insert(arguments.end(), {"--set", a});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, path);
  }
  ml::SafetensorsFile checkpoint(const std::string& out) const {
    return ml::SafetensorsFile::open(*this / (out + "/checkpoint.safetensors"));
  }
  std::vector<float> losses(const std::string& out) const {
    return ml::values_of<float>(checkpoint(out).tensor("losses"));
  }
  std::string weights(const std::string& out) const {
    return ml::read_file(*this / (out + "/model/weights.safetensors"));
  }
};
