// A model that puts texts and motions into one space, as searches use it: TMR, of train-tmr or as it was published.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/kinematics/motion.hpp>

namespace program {

namespace ml = motionlang;

class SearchModel {
 public:
  /// folder        of train-tmr, or the run folder of a published TMR
  /// text_encoder  folder of the language model whose states it reads, or a cache of them (.npy); "": it has its own
  ///               word pieces, or no texts are asked for
  /// Throws config_error 102 for a model of another system, and what the readers throw.
  SearchModel(const std::filesystem::path& folder, const std::filesystem::path& text_encoder);

  /// Of the weights: vectors of models with different ids cannot be compared.
  const std::string& id() const { return id_; }
  const std::filesystem::path& folder() const { return folder_; }
  const std::filesystem::path& text_encoder() const { return text_encoder_; }
  ml::Index width() const;  // of a vector
  double fps() const;

  /// (texts, width). Throws config_error 102 if the states of a language model are missing.
  std::vector<float> texts(std::span<const std::string> texts) const;
  /// What the model sees of a clip on any skeleton that can be retargeted: normalised features, (frames, features).
  std::vector<float> rows(const ml::Motion& motion) const;
  /// The same of rows of features that were made already.
  std::vector<float> normalized(std::span<const float> features) const;
  ml::Index frames(std::span<const float> rows) const;
  /// (windows, width): windows of the frames of `rows`.
  std::vector<float> windows(std::span<const float> rows, std::span<const ml::FrameSlice> windows) const;
  /// (width): a whole clip. One of more than ten seconds, which is longer than what such models are trained on, is cut
  /// into equal parts and has the mean of their directions.
  std::vector<float> clip(std::span<const float> rows) const;

 private:
  struct Parts;

  std::filesystem::path folder_, text_encoder_;
  std::string id_;
  std::shared_ptr<const Parts> parts_;
};

}  // namespace program
