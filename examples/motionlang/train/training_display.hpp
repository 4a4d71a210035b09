// The output of a training: a progress bar, and a summary at the end.
#pragma once

#include <cstdio>
#include <functional>
#include <optional>
#include <string>

#include <motionlang/train/trainer.hpp>

#include "../formatted.hpp"
#include "../progress_bar.hpp"

namespace program {

inline constexpr const char* about_recompute =
    "Recompute layers instead of storing their inner values. The result is the same; memory falls to a third or a "
    "half, "
    "and time rises by about half";

class TrainingDisplay {
 public:
  /// They refer to this object. Ctrl-C stops the run.
  motionlang::TrainingCallbacks callbacks(std::function<void()> prepare = {}) {
    return {.prepare = std::move(prepare),
            .start = [this](const motionlang::TrainingStart& s) { start(s); },
            .progress = [this](const motionlang::TrainingProgress& p) { return progress(p); },
            .stop =
                [this](motionlang::Index step, const std::filesystem::path& checkpoint) {
                  bar_->finish();
                  std::fprintf(stderr, "stopped at step %td; the same command continues from %s\n", step,
                               checkpoint.string().c_str());
                },
            .finish = [this](const motionlang::TrainingSummary& s) { finish(s); }};
  }

 private:
  void start(const motionlang::TrainingStart& s) {
    if (s.resumed) std::printf("continuing at step %td of %td\n", s.step, s.steps);
    bar_.emplace("training", s.step);
  }
  bool progress(const motionlang::TrainingProgress& p) {
    std::string note = formatted("loss %.4g", p.loss);
    if (!p.record.validations.empty()) {
      note += "  validation";
      for (const motionlang::Measure& m : p.record.validations.back().measures)
        note += formatted(" %s %.4g", m.name.c_str(), m.value);
    }
    bar_->note(note);
    return (*bar_)(p.step, p.steps);
  }
  void finish(const motionlang::TrainingSummary& s) {
    bar_->finish();
    if (s.stopped_early) std::printf("stopped early at step %td: the validation no longer improves\n", s.last_step);
    std::printf("trained  %s in %s\n", counted(s.steps, "step").c_str(), ProgressBar::clock(s.seconds).c_str());
  }

  std::optional<ProgressBar> bar_;
};

}  // namespace program
