// SPDX-License-Identifier: MIT
// Bodies of embedding_cache.hpp.
#pragma once

#include <filesystem>  // files that may be missing
#include <utility>     // exchange

#include <motionlang/core/utf8.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/weights/embedding_cache.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY EmbeddingCache EmbeddingCache::read(const FilePath& folder, const std::string& model) {
  const std::string base = folder.inside(model);
  const auto rows = MappedFile::open(base + ".npy"), index = MappedFile::open(base + "_index.json");
  std::shared_ptr<const MappedFile> slices;
  std::error_code ignored;
  if (const std::string path = base + "_slice.npy"; std::filesystem::exists(path, ignored))
    slices = MappedFile::open(path);
  return from_bytes(rows->bytes(), slices == nullptr ? std::nullopt : std::optional(slices->bytes()),
                    detail::as_text(index->bytes()), base, rows);
}

MOTIONLANG_BODY EmbeddingCache EmbeddingCache::from_bytes(std::span<const std::byte> row_file,
                                                          std::optional<std::span<const std::byte>> slice_file,
                                                          std::string_view index_text, const std::string& base,
                                                          std::shared_ptr<const void> owner) {
  const std::string slices = base + "_slice.npy", index = base + "_index.json";
  EmbeddingCache cache(0);
  cache.read_rows(row_file, base + ".npy", std::move(owner));
  const Index count = cache.row_count();
  if (slice_file) {
    const NpyArray array = parse_npy(*slice_file, slices);
    if (array.shape.size() != 2 || array.shape[1] != 2) raise<io_error>(403, slices, ": not pairs of rows");
    const auto bounds = array.to<std::int64_t>();
    for (std::size_t i = 0; i < bounds.size(); i += 2) {
      if (bounds[i] < 0 || bounds[i + 1] < bounds[i] || bounds[i + 1] > count)
        raise<io_error>(403, slices, ": text ", i / 2, " has the rows ", bounds[i], " ... ", bounds[i + 1], " of ",
                        count);
      cache.slices_.push_back({static_cast<Index>(bounds[i]), static_cast<Index>(bounds[i + 1])});
    }
  } else {
    for (Index i = 0; i < count; ++i) cache.slices_.push_back({i, i + 1});
  }
  std::vector<char> taken(cache.slices_.size(), false);
  const auto document = parse_json(index_text, index);
  for (const auto& [text, number] : JsonView(document, index).as<std::map<std::string, Index>>()) {
    if (number < 0 || number >= cache.count())
      raise<io_error>(403, index, ": '", text, "' has number ", number, " of ", cache.count());
    if (std::exchange(taken[static_cast<std::size_t>(number)], true))
      raise<io_error>(403, index, ": '", text, "' has number ", number, ", which another text has, too");
    cache.number_.emplace(text, static_cast<std::size_t>(number));
  }
  if (static_cast<Index>(cache.number_.size()) != cache.count())
    raise<io_error>(403, index, ": ", counted(cache.number_.size(), "text"), ", the rows are of ", cache.count());
  return cache;
}

MOTIONLANG_BODY void EmbeddingCache::write(const FilePath& folder, const std::string& model, bool with_slices) const {
  const std::string base = folder.inside(model);
  if (!folder.string().empty()) make_folder(folder.string());
  for (std::size_t from = 0, slash; (slash = model.find('/', from)) != model.npos; from = slash + 1)
    make_folder(folder.inside(model.substr(0, slash)));
  std::vector<std::int64_t> bounds;
  for (std::size_t i = 0; i < slices_.size(); ++i) {
    const auto [begin, end] = slices_[i];
    if (!with_slices && (begin != static_cast<Index>(i) || end != begin + 1))
      raise<io_error>(403, base, ": text ", i, " has ", counted(end - begin, "row"),
                      "; without slices every text has one");
    bounds.insert(bounds.end(), {begin, end});
  }
  nlohmann::json numbers = nlohmann::json::object();
  for (const auto& [text, number] : number_) numbers[text] = number;
  const std::string index = numbers.dump();
  write_npy(base + ".npy", NpyArray::of(rows(), {row_count(), width_}));
  if (with_slices)
    write_npy(base + "_slice.npy", NpyArray::of(std::span<const std::int64_t>(bounds), {count(), 2}));
  else
    std::remove((base + "_slice.npy").c_str());  // of an earlier cache in this place
  write_file(base + "_index.json", std::string_view(index));
}

MOTIONLANG_BODY std::span<const float> EmbeddingCache::find(const std::string& text) const {
  const auto found = number_.find(text);
  if (found == number_.end()) raise<config_error>(103, "embedding cache: no text '", text, "' among ", count());
  const auto [begin, end] = slices_[found->second];
  return rows().subspan(static_cast<std::size_t>(begin * width_), static_cast<std::size_t>((end - begin) * width_));
}

MOTIONLANG_BODY void EmbeddingCache::add(const std::string& text, std::span<const float> values) {
  if (width_ == 0 || values.size() % static_cast<std::size_t>(width_) != 0)
    raise<shape_error>(204, "embedding cache: ", counted(values.size(), "number"), " for rows of ", width_);
  if (contains(text)) raise<config_error>(102, "embedding cache: '", text, "' exists already");
  check_utf8(text);
  if (is_view_) {  // from here on in memory
    own_.assign(mapped_.begin(), mapped_.end());
    is_view_ = false;
    owner_.reset();
  }
  const Index begin = row_count();
  own_.insert(own_.end(), values.begin(), values.end());
  number_.emplace(text, slices_.size());
  slices_.push_back({begin, row_count()});
}

MOTIONLANG_BODY void EmbeddingCache::check_utf8(const std::string& text) {
  if (!is_utf8(text)) raise<io_error>(403, "embedding cache: the text '", text, "' is not UTF-8");
}

MOTIONLANG_BODY void EmbeddingCache::read_rows(std::span<const std::byte> bytes, const std::string& path,
                                               std::shared_ptr<const void> owner) {
  const auto npy = detail::npy_parts(bytes, path);
  const auto& shape = npy.header.shape;
  if (shape.size() != 2)
    raise<io_error>(403, path, ": ", counted(shape.size(), "axis", "axes"), ", expected rows of numbers");
  width_ = shape[1];
  const bool aligned = reinterpret_cast<std::uintptr_t>(npy.raw.data()) % alignof(float) == 0;
  if (npy.header.descr == "<f4" && !npy.header.fortran_order && aligned &&
      npy.raw.size() == detail::checked_size(shape, sizeof(float), path)) {
    is_view_ = true;
    owner_ = std::move(owner);
    mapped_ = {reinterpret_cast<const float*>(npy.raw.data()), npy.raw.size() / sizeof(float)};
  } else {
    own_ = parse_npy(bytes, path).to<float>();
  }
}

MOTIONLANG_NAMESPACE_END
