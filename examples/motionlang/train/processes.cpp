#include "processes.hpp"

#include <cstdio>
#include <map>
#include <optional>

#include <motionlang/train/mpi.hpp>

#include "../commands.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"

namespace program {

namespace ml = motionlang;

namespace {

#ifdef MOTIONLANG_MPI
std::optional<ml::MpiCommunicator> mpi;
#endif

ml::AnyCommunicator begin() {
  const ml::Index started = ml::started_processes();
  if (started == 1) return {};
#ifdef MOTIONLANG_MPI
  mpi.emplace();
  ml::AnyCommunicator all(*mpi);
  if (all.size() != started)
    ml::raise<usage_error>(
        102, started, " processes were started together, and MPI connects ", all.size(),
        ": srun needs its own option --mpi=pmix, and mpirun must be that of the MPI of this program");
  if (all.rank() > 0) {
    ProgressBar::quiet = true;
    if (std::freopen("/dev/null", "w", stdout) == nullptr)
      ml::raise<ml::io_error>(401, "/dev/null cannot be opened for the output of rank ", all.rank());
  }
  return all;
#else
  ml::raise<usage_error>(102, started,
                         " processes were started together, but this motionlang was built without MPI. Build it "
                         "where MPI is installed (Debian: libopenmpi-dev)");
#endif
}

}  // namespace

const ml::AnyCommunicator& processes() {
  static const ml::AnyCommunicator all = begin();
  return all;
}

int end_processes(int code) {
#ifdef MOTIONLANG_MPI
  if (mpi && mpi->size() > 1 && code != ok) mpi->abort(code);
  mpi.reset();
#endif
  return code;
}

void add_micro_batch_option(CLI::App& command, ml::TrainingOptions& o) {
  command
      .add_option("--micro-batch", o.micro_batch,
                  "Compute batches in parts of this many samples, which the processes of mpirun share. Any number of "
                  "processes gives the same weights. The default is to compute them as one, in one process")
      ->check(positive());
  const std::map<std::string, ml::GradientWire> wires{{"exact", ml::GradientWire::exact},
                                                      {"bf16", ml::GradientWire::bf16}};
  command
      .add_option("--wire", o.wire,
                  "How several processes send each other gradients. bf16 rounds them: half the bytes, but then the "
                  "weights depend on the number of processes. The default is exact")
      ->transform(CLI::CheckedTransformer(wires).description("exact or bf16"));
}

void require_one_process(const std::string& what) {
  if (processes().size() > 1) ml::raise<usage_error>(102, what, " runs in one process, not in ", processes().size());
}

const ml::AnyCommunicator& training_processes(const ml::TrainingOptions& o) {
  const ml::AnyCommunicator& all = processes();
  if (all.size() > 1 && o.micro_batch == 0)
    ml::raise<usage_error>(102, all.size(), " processes share the parts of a batch: --micro-batch is missing");
  if (all.size() > 1 && o.wire == ml::GradientWire::bf16)
    std::printf("gradients are rounded to bfloat16 on their way: the weights are not those of one process\n");
  return all;
}

}  // namespace program
