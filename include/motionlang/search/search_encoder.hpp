// SPDX-License-Identifier: MIT
/// The interface of an index and its searches to a model that puts texts and motions into one space. TMR implements it
/// (search/tmr_search_encoder.hpp). An index with another model works the same way.
#pragma once

#include <span>    // texts
#include <string>  // texts
#include <vector>  // vectors

#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/metrics/similarity_scale.hpp>
#include <motionlang/search/motion_index.hpp>
#include <motionlang/text/known_words.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Laws  equal inputs give equal vectors, independent of other inputs; several threads may call all functions at the
///       same time
class SearchEncoder {
 public:
  virtual ~SearchEncoder() = default;

  /// The source of the vectors: id of the weights, path, text encoder, width and frames per second. No windows.
  virtual const IndexModel& model() const = 0;
  /// (texts, width).
  virtual std::vector<float> encode_texts(std::span<const std::string> texts) const = 0;
  /// The model's input for a clip on any skeleton that can be retargeted: normalised features, (frames, features).
  virtual std::vector<float> rows_of(const Motion& motion) const = 0;
  /// The frames of such rows.
  virtual Index frames(std::span<const float> rows) const = 0;
  /// (windows, width): windows of the frames of `rows`.
  virtual std::vector<float> encode_windows(std::span<const float> rows, std::span<const FrameSlice> windows) const = 0;

  /// The meaning of the cosines of texts and motions; empty if it was not measured.
  virtual const SimilarityScale& similarity() const;
  /// The texts that the model learned from and that a query means; the query itself if the model cannot tell. None if
  /// the model learned from nothing like it. Throws what the encoder of these texts throws.
  virtual std::vector<std::string> meant(const std::string& query) const { return {query}; }
  /// The words that the model knows; empty if it cannot tell.
  virtual KnownWords known_words() const { return {}; }

 protected:
  SearchEncoder() = default;
  SearchEncoder(const SearchEncoder&) = default;
  SearchEncoder& operator=(const SearchEncoder&) = default;
};

/// (width): a whole clip. A clip of more than ten seconds is longer than the training clips of such models. It is cut
/// into equal parts and gets the mean of their directions.
std::vector<float> encode_clip(const SearchEncoder& encoder, std::span<const float> rows);
/// (width): the mean direction of one text or more, or the vector of a single one. Throws what
/// SearchEncoder::encode_texts throws, and shape_error 203 for no texts.
std::vector<float> encode_together(const SearchEncoder& encoder, std::span<const std::string> texts);
/// The vector of a motion as a query or as a clip of an index. Throws what SearchEncoder::rows_of throws.
std::vector<float> encode_motion(const SearchEncoder& encoder, const Motion& motion);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/search_encoder.ipp>
#endif
