#include "search_model.hpp"

#include <motionlang/backend/eigen.hpp>
#include <motionlang/search/motion_index_file.hpp>

#include "../files/motion_files.hpp"
#include "../train/text_motion_model.hpp"
#include "../train/text_sources.hpp"

namespace program {

using B = ml::EigenBackend<float>;

struct SearchModel::Parts {
  TmrModel<B> model;
  const ml::MotionFeatures* features = nullptr;
  double fps = 0;
};

SearchModel::SearchModel(const std::filesystem::path& folder, const std::filesystem::path& text_encoder)
    : folder_(folder), text_encoder_(text_encoder) {
  const TextMotionFile file = read_text_motion_config(folder);
  const auto weights = ml::open_weights(folder);
  id_ = ml::detail::index_checksum(weights.tensors());
  Parts parts;
  parts.model = load_text_motion<ml::Tmr, B>(weights, file);
  parts.features = &ml::motion_features(file.config.features);
  parts.fps = file.fps;
  parts_ = std::make_shared<const Parts>(std::move(parts));
}

ml::Index SearchModel::width() const { return parts_->model.system.motion_encoder.projection.out(); }
double SearchModel::fps() const { return parts_->fps; }

std::vector<float> SearchModel::texts(std::span<const std::string> texts) const {
  const auto& model = parts_->model;
  std::optional<ml::EmbeddingCache> states;
  if (!model.reads_texts() && !text_encoder_.empty()) states = token_states(text_encoder_, texts);
  constexpr std::size_t at_once = 128;
  std::vector<float> out;
  for (std::size_t begin = 0; begin < texts.size(); begin += at_once) {
    const auto some = texts.subspan(begin, std::min(at_once, texts.size() - begin));
    const auto vectors = model.system.encode_text(model.tokens(some, states ? &*states : nullptr)).mu.to_vector();
    out.insert(out.end(), vectors.begin(), vectors.end());
  }
  return out;
}

std::vector<float> SearchModel::rows(const ml::Motion& motion) const {
  const auto values = rows_of_motion(*parts_->features, motion, parts_->fps);
  return normalized(std::vector<float>(values.begin(), values.end()));
}

std::vector<float> SearchModel::normalized(std::span<const float> features) const {
  const ml::Index width = parts_->features->width;
  return parts_->model.motion_normalizer
      .normalize(ml::Tensor<B, 2>::from(features, {std::ssize(features) / width, width}))
      .to_vector();
}

ml::Index SearchModel::frames(std::span<const float> rows) const { return std::ssize(rows) / parts_->features->width; }

std::vector<float> SearchModel::windows(std::span<const float> rows, std::span<const ml::FrameSlice> windows) const {
  constexpr std::size_t at_once = 64;
  const ml::Index width = parts_->features->width;
  std::vector<float> out;
  for (std::size_t begin = 0; begin < windows.size(); begin += at_once) {
    std::vector<float> values;
    std::vector<ml::Index> lengths;
    for (const ml::FrameSlice& w : windows.subspan(begin, std::min(at_once, windows.size() - begin))) {
      const auto part =
          rows.subspan(static_cast<std::size_t>(w.first * width), static_cast<std::size_t>(w.length * width));
      values.insert(values.end(), part.begin(), part.end());
      lengths.push_back(w.length);
    }
    const ml::Offsets offsets(lengths);
    const ml::Sequences<B> motion(ml::Tensor<B, 2>::from(values, {offsets.rows(), width}), offsets);
    const auto vectors = parts_->model.system.encode_motion(motion).mu.to_vector();
    out.insert(out.end(), vectors.begin(), vectors.end());
  }
  return out;
}

std::vector<float> SearchModel::clip(std::span<const float> rows) const {
  const ml::Index all = frames(rows), longest = std::max<ml::Index>(1, std::lround(10 * fps())),
                  count = (all + longest - 1) / longest;
  std::vector<ml::FrameSlice> stretches;
  for (ml::Index i = 0; i < count; ++i) {
    const ml::Index first = all * i / count;
    stretches.push_back({first, all * (i + 1) / count - first});
  }
  auto vectors = windows(rows, stretches);
  if (count == 1) return vectors;
  vectors = ml::unit_rows(vectors, width());
  std::vector<float> mean(static_cast<std::size_t>(width()));
  for (std::size_t i = 0; i < vectors.size(); ++i) mean[i % mean.size()] += vectors[i] / static_cast<float>(count);
  return mean;
}

}  // namespace program
