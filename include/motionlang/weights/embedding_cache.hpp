// SPDX-License-Identifier: MIT
/// Embeddings of texts on disk, in the layout of TMR and STMC.
///
///     folder/<model>.npy          all rows of all texts, (rows, width), F32
///     folder/<model>_slice.npy    int64 (texts, 2): first row and one past the last; absent if every text has one row
///     and no slices are wanted (TMR's sent_embeddings)
///     folder/<model>_index.json   text -> its number
///
/// Folders    TMR: token_embeddings, sent_embeddings; STMC: text_embeddings, with slices
/// Model      "distilbert-base-uncased"; a slash makes a sub-folder ("ViT-B/32")
/// Texts      UTF-8, found by their exact characters; "" is a text like any other
/// Memory     rows stay in the mapped file
/// Atomicity  every file is replaced as a whole, after all of them are complete, and the index last. Files of two
///            caches (a reader came in between, or the disk is full) are refused only if their numbers of rows or texts
///            differ
/// Source     the folders token_embeddings and sent_embeddings of TMR, text_embeddings of STMC
#pragma once

#include <optional>       // slices that may be missing
#include <unordered_map>  // numbers of texts

#include <motionlang/file/file_path.hpp>
#include <motionlang/text/text_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// rows_of(text) -> the rows of the text, row-major.
template <Backend B, class F>
TextFeatures<B> features_of_rows(std::span<const std::string> texts, Index width, F rows_of) {
  std::vector<typename B::scalar> values;
  std::vector<Index> lengths;
  for (const std::string& t : texts) {
    const std::span<const float> rows = rows_of(t);
    values.insert(values.end(), rows.begin(), rows.end());
    lengths.push_back(static_cast<Index>(rows.size()) / std::max<Index>(1, width));
  }
  const Offsets offsets(lengths);
  return {{Tensor<B, 2>::from(values, {offsets.rows(), width}), offsets}};
}

}  // namespace detail

class EmbeddingCache {
 public:
  /// An empty cache.
  explicit EmbeddingCache(Index width) : width_(width) {}

  /// Throws io_error 401 if a file is missing, 403 if they do not fit each other, and what read_npy and read_json
  /// throw.
  static EmbeddingCache read(const FilePath& folder, const std::string& model);
  /// The same from files in memory; `base` appears in messages. The bytes of the rows must outlive the cache unless
  /// `owner` keeps them.
  static EmbeddingCache from_bytes(std::span<const std::byte> row_file,
                                   std::optional<std::span<const std::byte>> slice_file, std::string_view index_text,
                                   const std::string& base, std::shared_ptr<const void> owner = nullptr);

  /// Makes the folder and those inside it that the name of the model needs. Throws io_error 401; 403 for a text with
  /// several rows or none if slices are not wanted.
  void write(const FilePath& folder, const std::string& model, bool with_slices = true) const;

  /// The number of texts; the width of a row.
  Index count() const { return static_cast<Index>(slices_.size()); }
  Index width() const { return width_; }
  bool contains(const std::string& text) const { return number_.contains(text); }
  /// The rows of a text, row-major. Throws config_error 103 for a missing text.
  std::span<const float> find(const std::string& text) const;
  /// Adds a text; `values` are not rows of this cache itself. Throws shape_error 204 unless they are whole rows,
  /// config_error 102 for a text that the cache has already, io_error 403 for one that is not UTF-8, because the index
  /// could not be written.
  void add(const std::string& text, std::span<const float> values);
  /// Adds the texts that are missing. Throws shape_error 204 if the encoder gives rows of another width, and io_error
  /// 403 for a text that is not UTF-8, before it encodes anything.
  template <Backend B, TextEncoder<B> E>
  void add(const E& encoder, std::span<const std::string> texts) {
    std::vector<std::string> missing;
    std::unordered_map<std::string, bool> seen;
    for (const std::string& t : texts) {
      if (contains(t) || !seen.emplace(t, true).second) continue;
      check_utf8(t);
      missing.push_back(t);
    }
    if (missing.empty()) return;
    const TextFeatures<B> features = encoder.template encode<B>(std::span<const std::string>(missing));
    if (const Index width = features.tokens.width(); width != width_)
      raise<shape_error>(204, "embedding cache: an encoder with rows of ", counted(width, "number"),
                         ", here they have ", width_);
    for (std::size_t i = 0; i < missing.size(); ++i) {
      const auto rows = features.tokens[static_cast<Index>(i)].to_vector();
      add(missing[i], std::vector<float>(rows.begin(), rows.end()));
    }
  }

  /// The cache is a text encoder for its texts. Throws config_error 103 for others.
  template <Backend B>
  TextFeatures<B> encode(std::span<const std::string> texts) const {
    return detail::features_of_rows<B>(texts, width_, [&](const std::string& t) { return find(t); });
  }

 private:
  struct Slice {
    Index begin, end;
  };

  static void check_utf8(const std::string& text);
  std::span<const float> rows() const { return is_view_ ? mapped_ : std::span<const float>(own_); }
  Index row_count() const { return width_ == 0 ? 0 : static_cast<Index>(rows().size()) / width_; }

  /// Rows in the form that `write` writes are a view of the file; any other numeric array is converted.
  void read_rows(std::span<const std::byte> bytes, const std::string& path, std::shared_ptr<const void> owner);

  Index width_;
  std::vector<Slice> slices_;
  std::unordered_map<std::string, std::size_t> number_;
  std::vector<float> own_;
  std::span<const float> mapped_;
  bool is_view_ = false;
  std::shared_ptr<const void> owner_;
};

/// Takes texts from a cache, and encodes the others. Throws io_error 403 for a text that is not UTF-8.
template <class E>
struct CachedEncoder {
  EmbeddingCache cache;
  E encoder;

  template <Backend B>
  requires TextEncoder<E, B> TextFeatures<B> encode(std::span<const std::string> texts)
  const {
    EmbeddingCache others(cache.width());
    std::vector<std::string> unknown;
    for (const std::string& t : texts) {
      if (!cache.contains(t)) unknown.push_back(t);
    }
    others.add<B>(encoder, unknown);
    return detail::features_of_rows<B>(
        texts, cache.width(), [&](const std::string& t) { return cache.contains(t) ? cache.find(t) : others.find(t); });
  }
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/embedding_cache.ipp>
#endif
