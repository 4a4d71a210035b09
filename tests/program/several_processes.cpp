// Several processes under mpirun: the same bits as one, a process that is killed, and runs that are refused. Built
// where MPI is installed. `run` starts a shell here.
#include <doctest/doctest.h>

#include <algorithm>

#include "mpirun.hpp"
#include "training_clips.hpp"

namespace {

struct Processes : Clips {
  /// The command line of a tiny training, and `more`.
  static std::string command(const std::string& name, const std::string& out, const std::string& more) {
    std::string line = MOTIONLANG_TRAINED_PROGRAM " " + name + " --data . --out " + out + " --preset small --threads 1";
    const bool labels = name == "train-actor";
    line += labels ? " --labels labels.tsv" : " --captions captions.tsv";
    for (const char* a : {"data.min_seconds=0.5", "data.test_share=0.25", "data.validation_share=0.25",
                          "optimiser.batch=4", "validation.every=1", "network.latent_dim=8", "network.ff_size=8",
                          "network.num_layers=1", "network.num_heads=2"})
      line += std::string(" --set ") + a;
    if (!labels) {
      for (const char* a : {"data.mirror=false", "text.width=8", "text.vocabulary=40"})
        line += std::string(" --set ") + a;
    }
    if (name == "train-mdm-smpl") {
      for (const char* a : {"diffusion.steps=4", "text.ff_size=8", "text.num_layers=1", "text.num_heads=2"})
        line += std::string(" --set ") + a;
    }
    return line + " " + more;
  }
  static std::string mpirun(int processes) { return MOTIONLANG_MPIRUN " -n " + std::to_string(processes) + " "; }
  Outcome shell(const std::string& script) const { return run({"-c", open_mpi_variables + script}, path); }
  std::string checkpoint_bytes(const std::string& out) const {
    return ml::read_file(*this / (out + "/checkpoint.safetensors"));
  }
};

}  // namespace

TEST_CASE("one, two and four processes train the same model, and print once") {
  const Processes w;
  for (const std::string name : {"train-mdm-smpl", "train-actor", "train-tmr"}) {
    CAPTURE(name);
    const std::string more = "--micro-batch 1 --set optimiser.epochs=3";
    const Outcome alone = w.shell(Processes::command(name, name + "0", more));
    REQUIRE_MESSAGE(alone.code == 0, alone.text);
    for (const int processes : {1, 2, 4}) {
      const std::string out = name + std::to_string(processes);
      const Outcome o = w.shell(Processes::mpirun(processes) + Processes::command(name, out, more));
      REQUIRE_MESSAGE(o.code == 0, o.text);
      CHECK_MESSAGE(o.text.find("trained  ") == o.text.rfind("trained  "), o.text);
      CHECK(w.checkpoint_bytes(out) == w.checkpoint_bytes(name + "0"));
      CHECK(w.losses(out).size() >= 3);
      CHECK(ml::values_of<float>(ml::SafetensorsFile::open(w / (out + "/model/weights.safetensors")).tensors()[0]) ==
            ml::values_of<float>(ml::SafetensorsFile::open(w / (name + "0/model/weights.safetensors")).tensors()[0]));
    }
  }
}

TEST_CASE("when a process is killed, all end, and one process goes on from the last checkpoint with the same bits") {
  const Processes w;
  const std::string more = "--micro-batch 1 --save-minutes 0 --set validation.every=0 --set optimiser.epochs=60";
  const std::string whole = Processes::command("train-mdm-smpl", "whole", more),
                    killed = Processes::command("train-mdm-smpl", "killed", more);
  REQUIRE(w.shell(whole).code == 0);
  for (const char* signal : {"-KILL $first", "-KILL $last", "-TERM $first"}) {
    CAPTURE(signal);
    // The curves appear with the first checkpoint that has steps.
    const Outcome o = w.shell("rm -f killed/loss.svg\n" + Processes::mpirun(2) + killed +
                              " &\n"
                              "run=$!\n"
                              "while [ ! -e killed/loss.svg ]; do kill -0 $run || exit 99; sleep 0.01; done\n"
                              "first=$(cat /proc/$run/task/*/children | tr ' ' '\\n' | grep . | head -n 1)\n"
                              "last=$(cat /proc/$run/task/*/children | tr ' ' '\\n' | grep . | tail -n 1)\n"
                              "kill " +
                              signal + "\nwait $run\n");
    CAPTURE(o.text);
    if (contains(signal, "TERM")) {  // it saves before it ends
      CHECK(o.code == 130);
      CHECK(contains(o.text, "the same command continues from killed/checkpoint.safetensors"));
    } else {
      CHECK((o.code != 0 && o.code != 99));
    }
    const auto steps = w.losses("killed").size();
    CHECK((steps > 0 && steps < 60));
  }
  REQUIRE(w.shell(killed).code == 0);
  CHECK(w.checkpoint_bytes("killed") == w.checkpoint_bytes("whole"));
}

TEST_CASE("networks that normalise whole batches: the same bits, also when other processes go on") {
  const Processes w;
  const std::string program = MOTIONLANG_TRAINED_PROGRAM " ",
                    data =
                        " --data . --preset small --threads 1 --micro-batch 1 --set data.min_seconds=0.5 --set "
                        "data.test_share=0.25 --set data.validation_share=0.25 --set optimiser.batch=4 --set "
                        "optimiser.schedule=constant --set validation.every=1";  // else it follows the epochs
  const std::string stgcn = program + "train-classifier --labels labels.tsv" + data +
                            " --set kind=stgcn --set clips.translation=false --set width=4 --set clips.num_frames=12";
  const std::string tokenizer =
      program + "train-tm2t --stage tokenizer --captions captions.tsv" + data +
      " --set data.mirror=false --set 'tokenizer.channels=[8, 8]' --set tokenizer.codes=12 --set "
      "tokenizer.residual_blocks=1 --set tokenizer.window=28 --set tokenizer.adversarial=0.5 --set "
      "tokenizer.adversarial_from=1 --set tokenizer.discriminator=8";
  for (const std::string& line : {stgcn, tokenizer}) {
    CAPTURE(line);
    const std::string name = line == stgcn ? "stgcn" : "tokenizer";
    const auto train = [&](int processes, const std::string& out, int epochs) {
      const Outcome o = w.shell((processes == 0 ? "" : Processes::mpirun(processes)) + line + " --out " + out +
                                " --set optimiser.epochs=" + std::to_string(epochs));
      REQUIRE_MESSAGE(o.code == 0, o.text);
      return w.checkpoint_bytes(out);
    };
    const std::string alone = train(0, name, 4);
    for (const int processes : {2, 3, 4}) CHECK(train(processes, name + std::to_string(processes), 4) == alone);
    CHECK(train(4, name + "parts", 2) != alone);
    CHECK(train(2, name + "parts", 4) == alone);
  }
  const auto terms = w.terms("tokenizer");
  CHECK(std::find(terms.begin(), terms.end(), "adv") != terms.end());
}

TEST_CASE("several processes are refused without parts") {
  const Processes w;
  const Outcome parts = w.shell(Processes::mpirun(2) + Processes::command("train-mdm-smpl", "out", ""));
  CHECK(parts.code == 2);
  CHECK_MESSAGE(contains(parts.text, "[motionlang.config.102] 2 processes share the parts of a batch: --micro-batch"),
                parts.text);
  CHECK_FALSE(std::filesystem::exists(w / "out/checkpoint.safetensors"));
}

TEST_CASE("gradients as bfloat16: two processes, near the exact run, and the checkpoint says so") {
  const Processes w;
  const std::string more = "--micro-batch 1 --set optimiser.epochs=3 ";
  REQUIRE(w.shell(Processes::command("train-mdm-smpl", "exact", more)).code == 0);
  const Outcome o = w.shell(Processes::mpirun(2) + Processes::command("train-mdm-smpl", "bf16", more + "--wire bf16"));
  REQUIRE_MESSAGE(o.code == 0, o.text);
  CHECK_MESSAGE(contains(o.text, "gradients are rounded to bfloat16"), o.text);
  const auto exact = w.losses("exact"), rounded = w.losses("bf16");
  REQUIRE(rounded.size() == exact.size());
  CHECK(rounded != exact);
  for (std::size_t i = 0; i < exact.size(); ++i) CHECK(rounded[i] == doctest::Approx(exact[i]).epsilon(0.05));
  CHECK(w.checkpoint("bf16").metadata().at("training.wire") == "bf16");
  const Outcome other = w.shell(Processes::command("train-mdm-smpl", "bf16", more));
  CHECK(other.code == 1);
  CHECK_MESSAGE(contains(other.text, "this run began with another training.wire (bf16, not exact)"), other.text);
  const Outcome whole = w.shell(Processes::command("train-mdm-smpl", "out", "--wire bf16"));
  CHECK(whole.code == 2);
  CHECK_MESSAGE(
      contains(whole.text, "[motionlang.config.102] --wire bf16 rounds the gradients that processes send each"),
      whole.text);
}
