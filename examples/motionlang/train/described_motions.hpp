// Motions with texts or labels as rows of features, split into training, validation and test: what ACTOR, TEMOS and TMR
// are trained and measured on. From a folder of clips with a table, from folders in the form of HumanML3D or KIT-ML,
// and from the unified annotation file with the motions that it names.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <motionlang/core/fields.hpp>
#include <motionlang/core/progress.hpp>
#include <motionlang/datasets/annotations.hpp>
#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/text/tagged_word.hpp>

#include "config_json.hpp"
#include "left_out.hpp"

namespace program {

namespace ml = motionlang;

/// How a clip on SMPL's 24 joints, at `fps`, becomes rows of `width` numbers.
struct RowMaker {
  std::string name;
  ml::Index width = 0;
  double fps = 0;
  std::function<std::vector<double>(const ml::Motion&)> rows;
};

struct DescribedText {
  std::string text;
  ml::FrameSlice frames;                // of the rows, that it is about
  std::vector<ml::TaggedWord> words{};  // of data sets that have them: lemmas with their parts of speech
};
struct DescribedMotion {
  std::string id;           // of a table: "clip@start-end", or "clip": all of it; "M" in front: mirrored
  std::string clip;         // motions of one clip are never split
  std::vector<float> rows;  // (frames, width), not normalised
  std::vector<DescribedText> texts;
};

struct DescribedMotions {
  ml::Index width = 0;
  double fps = 0;
  std::vector<DescribedMotion> training, validation, test;
  LeftOut left_out{};

  std::array<const std::vector<DescribedMotion>*, 3> parts() const { return {&training, &validation, &test}; }
  /// Training, validation or test. Throws config_error 103.
  const std::vector<DescribedMotion>& part(const std::string& name) const;
};

std::vector<std::string> all_texts(const DescribedMotions& data);  // different ones

/// Where the motions are. One of `captions`, `labels` and `annotations`, or a `data` that is a folder in the form of
/// HumanML3D or KIT-ML; or `annotations` with `labels` for them.
struct DataSources {
  std::filesystem::path data;      // folder
  std::filesystem::path captions;  // table (clip_lines.hpp)
  std::filesystem::path labels;    // table, also of what the stretches, motions or texts of `annotations` are labelled
  std::filesystem::path
      annotations;  // JSON of TMR and STMC; its paths lead to .npy features, .npz (AMASS) or .bvh in `data`
  std::filesystem::path splits;  // folder with train.txt, val.txt and test.txt; of HumanML3D the data folder itself
  bool actions = false;          // labels are wanted, not texts, also where `annotations` has both
  std::shared_ptr<const ml::AnnotationFile> opened{};  // `annotations`, where it has been opened already

  bool labelled() const { return actions || !labels.empty(); }
};

/// The features of what is ready-made there, by the width of its rows: of the first clip to train on of a data set, or
/// of the first .npy file that the annotation file, which stays open, names. "" where there are clips only.
/// Throws io_error 401 to 405, 407 for rows of another width.
std::string ready_made_features(DataSources& sources);

struct DataConfig {
  double min_seconds = 2, max_seconds = 10;  // of what is trained on and validated with
  double test_share = 0.2;                   // of the clips, where there are no lists of ids
  double validation_share = 0.05;
  std::uint64_t split_seed = 1;
  bool mirror = false;  // mirrored clips with mirrored captions as well, of clips in a table, for training
  std::vector<std::string> actions{};  // labels to learn; none: all that there are

  void require_sound() const {
    for (const auto& [name, value] : {std::pair("test_share", test_share), {"validation_share", validation_share}})
      require_value(name, value, value >= 0 && value < 1, "0 or more, and less than 1");
    require_value("min_seconds", min_seconds, min_seconds >= 0, "0 or more");
    require_value("max_seconds", max_seconds, max_seconds > 0, "a number above 0");
  }
  static constexpr auto fields() {
    using C = DataConfig;
    return ml::fields("min_seconds", &C::min_seconds, "max_seconds", &C::max_seconds, "test_share", &C::test_share,
                      "validation_share", &C::validation_share, "split_seed", &C::split_seed, "mirror", &C::mirror,
                      "actions", &C::actions);
  }
};

/// Throws io_error 401, 403, ... of files (with the line of the table), config_error 102 if the sources contradict each
/// other or ready-made data cannot have the features of `rows`, io_error 407 for ready-made rows of another width.
DescribedMotions read_described_motions(const DataSources& sources, const DataConfig& config, const RowMaker& rows,
                                        ml::Progress progress);

}  // namespace program
