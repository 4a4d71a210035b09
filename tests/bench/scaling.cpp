// Training steps that several processes share, and their messages. scaling.py runs it and has the table and the model.
//
// usage: [mpirun -n RANKS] bench_scaling WORK THREADS STEPS BATCH MICRO_BATCH     WORK: tmr, mdm_smpl
//        mpirun -n 2 bench_scaling messages                                       latency and bandwidth
// MICRO_BATCH 0: the batch is not divided. Networks have the published sizes, motions are noise of 40 to 199 frames.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include <motionlang/core/parallel.hpp>
#include <motionlang/train/diffusion_training.hpp>
#include <motionlang/train/mpi.hpp>
#include <motionlang/train/tmr_training.hpp>

#include "../support/motions_of_noise.hpp"
#include "clock.hpp"

namespace {

namespace ml = motionlang;
using ml::Index;
using A = ml::Autodiff<ml::EigenBackend<float>>;

/// A communicator that measures another: seconds in messages, with those of waiting, and bytes that leave this process.
class Measured {
 public:
  explicit Measured(const ml::AnyCommunicator& c) : communicator_(c) {}

  Index rank() const { return communicator_.rank(); }
  Index size() const { return communicator_.size(); }
  void send(std::span<const std::byte> bytes, Index to) const {
    sent += static_cast<double>(bytes.size());
    timed([&] { communicator_.send(bytes, to); });
  }
  void receive(std::span<std::byte> bytes, Index from) const {
    timed([&] { communicator_.receive(bytes, from); });
  }
  void exchange(std::span<const std::byte> given, std::span<std::byte> taken, Index with) const {
    sent += static_cast<double>(given.size());
    timed([&] { communicator_.exchange(given, taken, with); });
  }
  bool arrived(Index from) const { return communicator_.arrived(from); }
  void broadcast(std::span<std::byte> bytes, Index root) const {
    if (rank() == root && size() > 1) sent += static_cast<double>(bytes.size());
    timed([&] { communicator_.broadcast(bytes, root); });
  }
  void barrier() const {
    timed([&] { communicator_.barrier(); });
  }
  mutable double seconds = 0, sent = 0;

 private:
  template <class F>
  void timed(const F& f) const {
    const double began = bench::now();
    f();
    seconds += bench::now() - began;
  }
  ml::AnyCommunicator communicator_;
};

ml::DescribedMotions noise(Index width, Index batch) {
  return motions_of_noise(
      width, static_cast<int>(4 * batch), static_cast<int>(4 * batch), [](int i) { return Index{40 + i * 37 % 160}; },
      [](int i, Index frames) {
        return std::vector<ml::DescribedText>{
            {"a person walks " + std::to_string(i % 7) + " steps and turns", {0, frames}}};
      });
}

/// The time of each step, of the slowest process, and the share of messages.
template <class Task>
void measure(const char* work, Task task, const ml::AnyCommunicator& all, Index steps, Index micro_batch) {
  const Measured measured(all);
  std::size_t parameters = 0;
  for (const auto& t : task.parameters()) parameters += static_cast<std::size_t>(t.shape().count());
  ml::Trainer trainer(std::move(task));
  trainer.divide(micro_batch, ml::AnyCommunicator(measured));
  trainer.step();  // memory is warm afterwards
  std::vector<double> times, messages;
  const double before = measured.sent;
  for (Index i = 0; i < steps; ++i) {
    all.barrier();
    const double began = bench::now(), in_messages = measured.seconds;
    trainer.step();
    times.push_back(bench::now() - began);
    messages.push_back(measured.seconds - in_messages);
  }
  std::sort(times.begin(), times.end()), std::sort(messages.begin(), messages.end());
  double mine[3] = {times[times.size() / 2], messages[messages.size() / 2],
                    (measured.sent - before) / static_cast<double>(steps)};
  double worst[3] = {mine[0], mine[1], mine[2]};
  for (Index r = 1; r < all.size(); ++r) {
    double other[3];
    if (all.rank() == r) all.send(std::as_bytes(std::span(mine)), 0);
    if (all.rank() == 0) {
      all.receive(std::as_writable_bytes(std::span(other)), r);
      for (int k = 0; k < 3; ++k) worst[k] = std::max(worst[k], other[k]);
    }
  }
  if (all.rank() == 0)
    std::printf("%s ranks %td threads %d micro %td parameters %zu step_ms %.1f messages_ms %.1f sent_mb %.1f\n", work,
                all.size(), ml::thread_count(), micro_batch, parameters, 1000 * worst[0], 1000 * worst[1],
                worst[2] / 1e6);
}

/// Half the time of there and back, for a small message and for large ones.
void messages(const ml::AnyCommunicator& all) {
  for (const std::size_t size : {std::size_t{8}, std::size_t{1} << 20, std::size_t{1} << 26}) {
    std::vector<std::byte> bytes(size);
    std::vector<double> times;
    for (int i = 0; i < 21; ++i) {
      all.barrier();
      const double began = bench::now();
      if (all.rank() == 0) all.send(bytes, 1), all.receive(bytes, 1);
      if (all.rank() == 1) all.receive(bytes, 0), all.send(bytes, 0);
      times.push_back((bench::now() - began) / 2);
    }
    std::sort(times.begin(), times.end());
    if (all.rank() == 0) std::printf("message bytes %zu us %.2f\n", size, 1e6 * times[times.size() / 2]);
  }
}

int run(const std::vector<std::string>& words, const ml::AnyCommunicator& all) {
  if (words.size() == 1 && words[0] == "messages" && all.size() == 2) return messages(all), 0;
  if (words.size() != 5) return std::fprintf(stderr, "the head of scaling.cpp has the usage\n"), 2;
  const auto number = [&](std::size_t i) { return static_cast<Index>(std::strtol(words[i].c_str(), nullptr, 10)); };
  ml::set_thread_count(static_cast<int>(number(1)));
  const Index batch = number(3);
  if (words[0] == "tmr") {
    auto config = ml::tmr_preset("tmr-published");
    config.text.encoder = "word_pieces", config.optimiser.batch = batch;
    const auto data = noise(263, batch);
    measure("tmr", ml::TmrTraining<A>(config, data), all, number(2), number(4));
  } else {
    auto config = ml::mdm_smpl_preset("mdm-smpl-published");
    config.text.encoder = "word_pieces", config.optimiser.batch = batch;
    const auto data = noise(205, batch);
    measure("mdm_smpl", ml::MdmSmplTraining<A>(config, data), all, number(2), number(4));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (ml::started_processes() == 1) return run(words, ml::AnyCommunicator());
  const ml::MpiCommunicator mpi;
  return run(words, ml::AnyCommunicator(mpi));
}
