// SPDX-License-Identifier: MIT
// Bodies of index_shards.hpp.
#pragma once

#include <algorithm>  // upper_bound
#include <cerrno>     // a name that is taken
#include <cmath>      // sqrt
#include <cstdlib>    // strtol
#include <utility>    // exchange

#include <motionlang/core/formatted.hpp>
#include <motionlang/core/option_error.hpp>
#include <motionlang/core/parallel.hpp>
#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/detail/json_text.hpp>
#include <motionlang/file/detail/system_file.hpp>
#include <motionlang/search/index_shards.hpp>
#include <motionlang/search/motion_index_file.ipp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr const char* shards_format = "motionlang.shards";
inline constexpr Index shards_version = 1, least_shard_bytes = Index{16} << 10;

/// Tells the system that a part of a mapped file is read soon.
inline void announce(std::span<const std::byte> part) {
  if (const MappedFile* file = MappedFile::that_holds(part)) {
    constexpr std::size_t page = 65536;  // a multiple of every system's pages
    const auto begin = static_cast<std::size_t>(part.data() - file->bytes().data()) / page * page;
    const auto end = static_cast<std::size_t>(part.data() - file->bytes().data()) + part.size();
    if (begin < end) system::will_read(file->bytes().data() + begin, end - begin);
  }
}

/// Exact search in shards, one after the other: the k-th best so far bounds what the next one has to compare.
class ShardScan : public VectorSearch {
 public:
  struct Piece {
    RowScan<float> scan;
    Index first = 0;  // the number of its first vector
    std::shared_ptr<const void> owner;
  };
  ShardScan(std::vector<Piece> pieces, Index count, Index width)
      : pieces_(std::move(pieces)), count_(count), width_(width) {}

  Index count() const override { return count_; }
  Index width() const override { return width_; }
  std::vector<std::vector<Neighbour>> search(std::span<const float> queries, Index k) const override {
    if (k < 0) raise<config_error>(101, "IndexShards: the ", k, " nearest");
    whole_rows("IndexShards: queries", queries.size(), width_);
    const auto wanted = unit_rows(queries, width_);
    std::vector<NearestK> best(wanted.size() / static_cast<std::size_t>(width_), NearestK(std::min(k, count_)));
    for (std::size_t p = 0; p < pieces_.size() && k > 0 && !best.empty(); ++p) {
      if (p + 1 < pieces_.size()) announce(std::as_bytes(pieces_[p + 1].scan.codes));
      std::vector<float> least;
      least.reserve(best.size());
      for (const NearestK& b : best) least.push_back(b.least());
      const auto found = pieces_[p].scan.nearest(wanted, std::min(k, pieces_[p].scan.count), least);
      for (std::size_t q = 0; q < best.size(); ++q) {
        for (const Neighbour& n : found[q]) best[q].offer({pieces_[p].first + n.index, n.score});
      }
    }
    std::vector<std::vector<Neighbour>> out;
    out.reserve(best.size());
    for (NearestK& b : best) out.push_back(b.take());
    return out;
  }

 private:
  std::vector<Piece> pieces_;
  Index count_, width_;
};

/// A table of a shard with its codes.
struct CodedRows {
  std::span<const float> rows, bounds;
  std::span<const std::int8_t> codes;
};

inline std::string shape_text(const TensorView& t) { return concat_text(t.dtype, " ", t.shape); }

/// A tensor of this type and shape, in place. Throws io_error 406, 407, and 403 if it is not aligned.
template <class T>
std::span<const T> shard_tensor(const SafetensorsFile& file, const std::string& name, const FileShape& shape) {
  const TensorView& t = file.tensor(name);
  if (t.dtype != dtype_of<T>() || t.shape != shape)
    raise<io_error>(407, file.name(), ": '", name, "' is ", shape_text(t), ", the list of shards wants ", dtype_of<T>(),
                    " ", shape);
  const auto values = direct<T>(t);
  if (!values) raise<io_error>(403, file.name(), ": '", name, "' does not begin at a multiple of ", sizeof(T));
  return *values;
}
inline CodedRows coded_rows(const SafetensorsFile& file, const std::string& name, Index count, Index width) {
  return {shard_tensor<float>(file, name, {count, width}), shard_tensor<float>(file, name + "_bounds", {count, 2}),
          shard_tensor<std::int8_t>(file, name + "_codes", {count, width})};
}

/// The model without its place.
inline std::string comparable(IndexModel m) {
  m.path.clear(), m.text_encoder.clear();
  return json_text(index_model_json(m));
}

/// Throws io_error 403 with the first row whose bounds do not hold.
inline void check_codes(const SafetensorsFile& file, const std::string& name, const CodedRows& t, Index width) {
  const Index count = std::ssize(t.bounds) / 2;
  parallel_for(count, [&](Index r) {
    const double scale = static_cast<double>(t.bounds[static_cast<std::size_t>(2 * r)]),
                 allowed = static_cast<double>(t.bounds[static_cast<std::size_t>(2 * r + 1)]);
    double square = 0;
    for (auto i = static_cast<std::size_t>(r * width); i < static_cast<std::size_t>((r + 1) * width); ++i) {
      const double d = static_cast<double>(t.rows[i]) - scale * static_cast<double>(t.codes[i]);
      square += d * d;
    }
    if (!(std::sqrt(square) <= allowed))
      raise<io_error>(403, file.name(), ": '", name, "': the codes of vector ", r, " of ", count, " are off by ",
                      std::sqrt(square), ", more than the allowance ", allowed);
  });
}

inline ShardList shard_list(std::string_view text, const std::string& path) {
  const auto document = parse_json(text, path);
  const JsonView list(document, path);
  if (list.value_or("format", "") != shards_format) raise<io_error>(403, path, ": not a list of shards of motionlang");
  if (const Index version = list["version"].as<Index>(); version != shards_version)
    raise<io_error>(404, path, ": version ", version, " of a list of shards, expected ", shards_version);
  ShardList out{.model = index_model(list["model"]), .shard_bytes = list["shard_bytes"].as<Index>(), .shards = {}};
  const MotionIndex checked(out.model);
  if (out.shard_bytes < least_shard_bytes)
    raise<io_error>(403, path, ": shards of ", counted(out.shard_bytes, "byte"), "; at least ", least_shard_bytes);
  const JsonView shards = list["shards"];
  for (Index i = 0; i < shards.size(); ++i) {
    const JsonView s = shards[i];
    ShardEntry& e = out.shards.emplace_back();
    e = {.file = s["file"].as<std::string>(),
         .checksum = s["checksum"].as<std::string>(),
         .bytes = s["bytes"].as<Index>(),
         .clips = s["clips"].as<Index>(),
         .moments = s["moments"].as<Index>(),
         .captions = s["captions"].as<Index>()};
    // Sums of as many as a list can name stay in an Index; with 32 bits, those of eight shards.
    constexpr Index most = std::numeric_limits<Index>::max() >> (sizeof(Index) == 8 ? 13 : 3);
    for (const Index n : {e.bytes, e.clips, e.moments, e.captions}) {
      if (n < 0 || n > most) raise<io_error>(403, s.path(), ": a size of ", n);
    }
    constexpr std::string_view elsewhere("/\\:\0", 4);
    if (e.file.empty() || e.file.find_first_of(elsewhere) != e.file.npos || e.file.front() == '.')
      raise<io_error>(403, s.path(), ": '", e.file, "' does not name a file in this folder");
  }
  return out;
}

inline std::string shard_list_text(const ShardList& list) {
  auto shards = nlohmann::ordered_json::array();
  for (const ShardEntry& e : list.shards) {
    shards.push_back({{"file", e.file},
                      {"checksum", e.checksum},
                      {"bytes", e.bytes},
                      {"clips", e.clips},
                      {"moments", e.moments},
                      {"captions", e.captions}});
  }
  const nlohmann::ordered_json all{{"format", shards_format},
                                   {"version", shards_version},
                                   {"model", index_model_json(list.model)},
                                   {"shard_bytes", list.shard_bytes},
                                   {"shards", std::move(shards)}};
  return json_text(all, 2) + "\n";
}

}  // namespace detail

MOTIONLANG_BODY bool is_shard_folder(const FilePath& folder) {
  return std::filesystem::is_regular_file(std::filesystem::path(folder.string()) / shard_list_name);
}

MOTIONLANG_BODY ShardList read_shard_list(const FilePath& folder) {
  const std::string path = (std::filesystem::path(folder.string()) / shard_list_name).string();
  return detail::shard_list(read_file(path), path);
}

// ---- reading

MOTIONLANG_BODY std::shared_ptr<const IndexShards> IndexShards::open(const FilePath& folder) {
  std::shared_ptr<const IndexShards> out;
  detail::with_current_list(folder, [&](const ShardList& list) { out.reset(new IndexShards(folder, list)); });
  return out;
}

MOTIONLANG_BODY IndexShards::IndexShards(const FilePath& folder, ShardList list)
    : name_(folder.string()), list_(std::move(list)) {
  for (const ShardEntry& e : list_.shards) {
    shards_.push_back(open_shard(e, shards_.size()));
    shards_.back().clip = std::exchange(clips_, clips_ + e.clips);
    shards_.back().moment = std::exchange(moments_, moments_ + e.moments);
    shards_.back().caption = std::exchange(captions_, captions_ + e.captions);
  }
}

MOTIONLANG_BODY std::string IndexShards::path_of(const ShardEntry& entry) const {
  return (std::filesystem::path(name_) / entry.file).string();
}

MOTIONLANG_BODY IndexShards::Shard IndexShards::open_shard(const ShardEntry& e, std::size_t number) const {
  const std::string path = path_of(e);
  if (!std::filesystem::exists(path))
    raise<io_error>(401, path, " is missing: shard ", number + 1, " of ", list_.shards.size(), " in the list ",
                    shard_list_name);
  const auto mapped = MappedFile::open(path);
  if (std::ssize(mapped->bytes()) != e.bytes)
    raise<io_error>(std::ssize(mapped->bytes()) < e.bytes ? 402 : 403, path, ": ",
                    counted(mapped->bytes().size(), "byte"), ", the list ", shard_list_name, " says ", e.bytes);
  Shard out{.file = SafetensorsFile::from_bytes(mapped->bytes(), path, mapped)};
  const SafetensorsFile& file = out.file;
  detail::require_index(file);
  const std::string where = path + ": model", text = detail::metadata_of(file, "model");
  const auto document = parse_json(text.empty() ? "{}" : text, where);
  const IndexModel model = detail::index_model(JsonView(document, where));
  if (model.id != list_.model.id)
    raise<config_error>(102, path, ": made with the model '", model.path, "' (", model.id, "), the other shards with '",
                        list_.model.path, "' (", list_.model.id, "); their vectors cannot be compared");
  if (const std::string is = detail::comparable(model), all = detail::comparable(list_.model); is != all)
    raise<io_error>(403, path, ": moments as in ", is, ", the list ", shard_list_name, " says ", all);
  if (const std::string sum = detail::metadata_of(file, "checksum"); sum != e.checksum)
    raise<io_error>(403, path, ": its checksum is ", sum, ", the list ", shard_list_name, " says ", e.checksum);
  const Index width = list_.model.width;
  detail::coded_rows(file, "clips", e.clips, width);
  detail::coded_rows(file, "moments", e.moments, width);
  detail::coded_rows(file, "captions", e.captions, width);
  detail::shard_tensor<std::int64_t>(file, "moment_frames", {e.moments, 3});
  detail::shard_tensor<std::int64_t>(file, "clip_places", {e.clips, 2});
  detail::shard_tensor<std::int64_t>(file, "caption_clips", {e.captions});
  file.tensor("about");
  return out;
}

MOTIONLANG_BODY const IndexShards::Shard& IndexShards::shard_of(Index Shard::*first, Index i) const {
  const auto behind = std::upper_bound(shards_.begin(), shards_.end(), i,
                                       [&](Index value, const Shard& s) { return value < s.*first; });
  return *std::prev(behind);
}

template <class T>
std::vector<T> IndexShards::numbers_at(const Shard& shard, const char* tensor, Index row) {
  const TensorView& t = shard.file.tensor(tensor);
  const auto numbers = direct<T>(t).value();
  const std::size_t each = t.shape.rank() > 1 ? static_cast<std::size_t>(t.shape[1]) : 1;
  const auto mine = numbers.subspan(static_cast<std::size_t>(row) * each, each);
  return {mine.begin(), mine.end()};
}

MOTIONLANG_BODY IndexedClip IndexShards::clip(Index i) const {
  const Shard& s = shard_of(&Shard::clip, i);
  const auto place = numbers_at<std::int64_t>(s, "clip_places", i - s.clip);
  const std::string_view about = detail::as_text(s.file.tensor("about").bytes);
  const std::string where = concat_text(s.file.name(), ": clip ", i - s.clip);
  if (place[0] < 0 || place[1] < place[0] || place[1] > std::ssize(about))
    raise<io_error>(403, where, ": its text is from byte ", place[0], " to ", place[1], " of ", about.size());
  const auto document = parse_json(
      about.substr(static_cast<std::size_t>(place[0]), static_cast<std::size_t>(place[1] - place[0])), where);
  return detail::indexed_clip(JsonView(document, where));
}

MOTIONLANG_BODY MotionIndex::Moment IndexShards::moment(Index i) const {
  const Shard& s = shard_of(&Shard::moment, i);
  const auto n = numbers_at<std::int64_t>(s, "moment_frames", i - s.moment);
  const Index clips = s.file.tensor("clips").shape[0];
  constexpr Index most = std::numeric_limits<Index>::max();
  if (n[0] < 0 || n[0] >= clips || n[1] < 0 || n[2] < 1 || n[1] > most - n[2])
    raise<io_error>(403, s.file.name(), ": a moment of ", n[2], " frames at ", n[1], " of clip ", n[0], " among ",
                    clips);
  return {s.clip + static_cast<Index>(n[0]), {static_cast<Index>(n[1]), static_cast<Index>(n[2])}};
}

MOTIONLANG_BODY Index IndexShards::clip_of_caption(Index i) const {
  const Shard& s = shard_of(&Shard::caption, i);
  const std::int64_t clip = numbers_at<std::int64_t>(s, "caption_clips", i - s.caption)[0];
  const Index clips = s.file.tensor("clips").shape[0];
  if (clip < 0 || clip >= clips)
    raise<io_error>(403, s.file.name(), ": caption ", i - s.caption, " is of clip ", clip, " among ", clips);
  return s.clip + static_cast<Index>(clip);
}

MOTIONLANG_BODY std::shared_ptr<const VectorSearch> IndexShards::vectors(SearchFor what, Index part,
                                                                         Index parts) const {
  const auto scan = [&](const char* table, Index Shard::*first) {
    std::vector<detail::ShardScan::Piece> pieces;
    for (std::size_t i = static_cast<std::size_t>(part); i < shards_.size(); i += static_cast<std::size_t>(parts)) {
      const Shard& s = shards_[i];
      const Index count = s.file.tensor(table).shape[0];
      if (count == 0) continue;
      const auto t = detail::coded_rows(s.file, table, count, model().width);
      pieces.push_back({{.rows = t.rows,
                         .halves = {},
                         .count = count,
                         .width = model().width,
                         .half_error = 0,
                         .codes = t.codes,
                         .bounds = t.bounds,
                         .name = concat_text(s.file.name(), ": '", table, "'")},
                        s.*first,
                        s.file.owner()});
    }
    return std::make_shared<detail::ShardScan>(std::move(pieces), gallery_size(*this, what), model().width);
  };
  switch (what) {
    case SearchFor::moments:
      return scan("moments", &Shard::moment);
    case SearchFor::captions:
      return scan("captions", &Shard::caption);
    case SearchFor::clips:
      break;
  }
  return scan("clips", &Shard::clip);
}

MOTIONLANG_BODY MotionIndex IndexShards::whole() const {
  std::vector<IndexedClip> clips;
  std::vector<MotionIndex::Moment> moments;
  VectorTable rows[3];
  for (std::size_t i = 0; i < shards_.size(); ++i) {
    const MotionIndexFile shard = MotionIndexFile::open(path_of(list_.shards[i]));
    const MotionIndex& index = shard.index();
    for (const MotionIndex::Moment& m : index.moments()) moments.push_back({std::ssize(clips) + m.clip, m.frames});
    clips.insert(clips.end(), index.clips().begin(), index.clips().end());
    rows[0].append(index.clip_rows()), rows[1].append(index.moment_rows()), rows[2].append(index.caption_rows());
  }
  return MotionIndex(name_, list_.model, std::move(clips), std::move(moments), std::move(rows[0]), std::move(rows[1]),
                     std::move(rows[2]));
}

MOTIONLANG_BODY void IndexShards::check(Progress progress) const {
  for (std::size_t i = 0; i < shards_.size(); ++i) {
    const SafetensorsFile& file = shards_[i].file;
    const auto opened = MotionIndexFile::from_bytes(MappedFile::that_holds(file.tensor("about").bytes)->bytes(),
                                                    file.name(), file.owner());
    const MotionIndex& index = opened.index();
    for (Index c = 0; c < index.count(); ++c) {
      if (!(clip(shards_[i].clip + c) == index.clips()[static_cast<std::size_t>(c)]))
        raise<io_error>(403, file.name(), ": 'clip_places' does not fit the clips: that of clip ", c,
                        " leads to another text");
    }
    const auto of_captions = direct<std::int64_t>(file.tensor("caption_clips")).value();
    if (!std::equal(of_captions.begin(), of_captions.end(), index.caption_clips().begin(), index.caption_clips().end()))
      raise<io_error>(403, file.name(), ": 'caption_clips' does not fit the clips");
    for (const char* table : {"clips", "moments", "captions"}) {
      const Index count = file.tensor(table).shape[0];
      detail::check_codes(file, table, detail::coded_rows(file, table, count, model().width), model().width);
    }
    progress(static_cast<Index>(i) + 1, std::ssize(shards_));
  }
}

MOTIONLANG_BODY MotionSearch open_motion_search(std::shared_ptr<const IndexShards> shards, Index part, Index parts) {
  const auto in = [&](SearchFor what) { return shards->vectors(what, part, parts); };
  auto clips = in(SearchFor::clips), moments = in(SearchFor::moments), captions = in(SearchFor::captions);
  return MotionSearch(std::move(shards), std::move(clips), std::move(moments), std::move(captions));
}

// ---- writing

MOTIONLANG_BODY ShardStore::ShardStore(const FilePath& folder, const IndexModel& model, Index shard_bytes)
    : folder_(folder.string()) {
  if (shard_bytes < detail::least_shard_bytes)
    raise<option_error>(102, folder.string(), ": shards of ", counted(shard_bytes, "byte"), "; at least ",
                        detail::least_shard_bytes);
  if (is_shard_folder(folder)) {
    const auto shards = IndexShards::open(folder);
    if (shards->model().id != model.id) MotionIndex(shards->model()).require_model(model.id, model.path);
    take_up(*shards);
    list_.shard_bytes = shard_bytes;
    return;
  }
  std::error_code none;
  if (std::filesystem::exists(folder_) && !std::filesystem::is_empty(folder_, none))
    raise<io_error>(403, folder.string(), " has other files, and no ", shard_list_name);
  make_folder(folder);
  list_ = {.model = MotionIndex(model).model(), .shard_bytes = shard_bytes, .shards = {}};
}

MOTIONLANG_BODY ShardStore::ShardStore(const FilePath& folder, Index shard_bytes) : folder_(folder.string()) {
  take_up(*IndexShards::open(folder));
  if (shard_bytes > 0) list_.shard_bytes = std::max(shard_bytes, detail::least_shard_bytes);
}

MOTIONLANG_BODY void ShardStore::take_up(const IndexShards& shards) {
  list_ = shards.list();
  published_ = list_;
  changed_.assign(list_.shards.size(), false);
  moments_ = shards.moment_count();
  clips_.clear(), origins_.clear();
  for (std::size_t s = 0; s < list_.shards.size(); ++s) {
    for (Index c = 0; c < list_.shards[s].clips; ++c) {
      clips_.push_back(shards.clip(std::ssize(clips_)));
      origins_.push_back({static_cast<Index>(s), c, 0});
    }
    const std::string& name = list_.shards[s].file;
    const auto digits = name.find_first_of("0123456789");
    const long number = digits == name.npos ? 0 : std::strtol(name.c_str() + digits, nullptr, 10);
    if (number < 1'000'000'000) next_number_ = std::max<Index>(next_number_, number + 1);
  }
  for (Index m = 0; m < moments_; ++m) ++origins_[static_cast<std::size_t>(shards.moment(m).clip)].moments;
}

MOTIONLANG_BODY void ShardStore::touch(std::size_t clip) {
  if (origins_[clip].shard >= 0) changed_[static_cast<std::size_t>(origins_[clip].shard)] = true;
}

MOTIONLANG_BODY void ShardStore::rename(const std::string& from, const std::string& to) {
  for (std::size_t i = 0; i < clips_.size(); ++i) {
    if (clips_[i].path == from) clips_[i].path = to, touch(i);
  }
  if (open_) open_->rename(from, to);
}

MOTIONLANG_BODY void ShardStore::set_license(const std::string& path, const std::string& license) {
  for (std::size_t i = 0; i < clips_.size(); ++i) {
    if (clips_[i].path == path) clips_[i].license = license, touch(i);
  }
  if (open_) open_->set_license(path, license);
}

MOTIONLANG_BODY void ShardStore::move_model(std::string path, std::string text_encoder) {
  list_.model.path = std::move(path), list_.model.text_encoder = std::move(text_encoder);
}

MOTIONLANG_BODY void ShardStore::remove(const std::vector<bool>& gone) {
  if (!finished_.empty() || open_) write();  // then all have a shard
  std::size_t kept = 0;
  for (std::size_t i = 0; i < clips_.size(); ++i) {
    if (gone[i]) {
      touch(i);
      moments_ -= origins_[i].moments;
    } else {
      if (kept != i) clips_[kept] = std::move(clips_[i]), origins_[kept] = origins_[i];
      ++kept;
    }
  }
  clips_.resize(kept), origins_.resize(kept);
}

namespace detail {

/// The bytes that a clip takes in a shard.
inline Index bytes_in_shard(const IndexedClip& clip, Index moments, Index width) {
  const Index captions = std::ssize(clip.captions), rows = 1 + moments + captions;
  return rows * (width * 5 + 8) + 24 * moments + 8 * captions + 16 + std::ssize(json_text(indexed_clip_json(clip))) + 1;
}
inline constexpr Index bytes_of_header = 8192;  // and of what else a shard has

}  // namespace detail

/// The last shard of the list goes on if it is at most half full.
MOTIONLANG_BODY void ShardStore::take_up_last_shard() {
  const auto last = std::ssize(list_.shards) - 1;
  if (last < 0 || list_.shards.back().bytes > list_.shard_bytes / 2) return;
  std::size_t first = origins_.size();
  while (first > 0 && origins_[first - 1].shard == last) --first;
  open_ = changed_shard(last, std::span(clips_).subspan(first), std::span(origins_).subspan(first));
  open_bytes_ = detail::bytes_of_header;
  for (std::size_t i = first; i < origins_.size(); ++i) {
    open_bytes_ += detail::bytes_in_shard(clips_[i], origins_[i].moments, list_.model.width);
    origins_[i].shard = -1;
  }
  list_.shards.pop_back(), changed_.pop_back();
}

MOTIONLANG_BODY void ShardStore::add(EncodedClip c) {
  if (!open_) {
    if (finished_.empty()) take_up_last_shard();
    if (!open_) open_.emplace(list_.model), open_bytes_ = detail::bytes_of_header;
  }
  const auto moments = std::ssize(c.moments);
  const Index more = detail::bytes_in_shard(c.clip, moments, list_.model.width);
  if (open_->count() > 0 && open_bytes_ + more > list_.shard_bytes) {
    finished_.push_back(write_shard(*open_));
    open_.emplace(list_.model), open_bytes_ = detail::bytes_of_header;
  }
  IndexedClip clip = c.clip;
  open_->add(std::move(c));
  open_bytes_ += more, moments_ += moments;
  clips_.push_back(std::move(clip));
  origins_.push_back({-1, 0, moments});
}

MOTIONLANG_BODY ShardEntry ShardStore::write_shard(const MotionIndex& index) {
  const Index width = list_.model.width;
  std::vector<std::int64_t> places;
  const std::string about = detail::index_about(index, &places);
  const std::vector<std::int64_t> caption_clips(index.caption_clips().begin(), index.caption_clips().end());
  struct Codes {
    std::vector<std::int8_t> codes;
    std::vector<float> bounds;
  } coded[3];
  std::vector<TensorView> more{tensor_view<std::int64_t>("clip_places", {index.count(), 2}, places),
                               tensor_view<std::int64_t>("caption_clips", {std::ssize(caption_clips)}, caption_clips)};
  const auto add_codes = [&](Codes& c, const std::string& table, std::span<const float> rows) {
    const Index count = std::ssize(rows) / width;
    c.codes.resize(rows.size()), c.bounds.resize(2 * static_cast<std::size_t>(count));
    detail::RowScan<float>::to_codes(rows, width, c.codes.data(), c.bounds.data());
    more.push_back(tensor_view<std::int8_t>(table + "_codes", {count, width}, c.codes));
    more.push_back(tensor_view<float>(table + "_bounds", {count, 2}, c.bounds));
  };
  add_codes(coded[0], "clips", index.clip_rows());
  add_codes(coded[1], "moments", index.moment_rows());
  add_codes(coded[2], "captions", index.caption_rows());
  const auto bytes =
      detail::index_bytes(index, about, more, {{"model", detail::json_text(detail::index_model_json(index.model()))}});
  ShardEntry e{.file = new_file_name(),
               .checksum = detail::metadata_of(SafetensorsFile::from_bytes(bytes), "checksum"),
               .bytes = std::ssize(bytes),
               .clips = index.count(),
               .moments = std::ssize(index.moments()),
               .captions = std::ssize(caption_clips)};
  write_file((folder_ / e.file).string(), bytes);
  return e;
}

/// The rest of a shard of the list, as these entries say.
MOTIONLANG_BODY MotionIndex ShardStore::changed_shard(Index shard, std::span<const IndexedClip> clips,
                                                      std::span<const Origin> origins) const {
  MotionIndex out = read_motion_index((folder_ / list_.shards[static_cast<std::size_t>(shard)].file).string());
  std::size_t next = 0;
  Index number = 0;
  out.remove_if([&](const IndexedClip&) {
    const bool stays = next < origins.size() && origins[next].clip == number++;
    next += stays ? 1 : 0;
    return !stays;
  });
  VectorTable rows[3];
  rows[0].append(out.clip_rows()), rows[1].append(out.moment_rows()), rows[2].append(out.caption_rows());
  return MotionIndex(list_.shards[static_cast<std::size_t>(shard)].file, list_.model, {clips.begin(), clips.end()},
                     {out.moments().begin(), out.moments().end()}, std::move(rows[0]), std::move(rows[1]),
                     std::move(rows[2]));
}

/// A name that no file has. The file is made at once, so no other program takes the name.
MOTIONLANG_BODY std::string ShardStore::new_file_name() {
  for (;;) {
    std::string name = formatted("shard-%05td.index", next_number_++);
    const int file = detail::system::create((folder_ / name).string().c_str());
    if (file < 0 && errno == EEXIST) continue;
    if (file >= 0) ::close(file);  // otherwise write_file says why
    made_.push_back(name);
    return name;
  }
}

MOTIONLANG_BODY void ShardStore::require_same_list() const {
  std::optional<ShardList> now;
  if (is_shard_folder(folder_)) now = read_shard_list(folder_);
  if (now != published_)
    raise<io_error>(403, (folder_ / shard_list_name).string(),
                    ": another program has written this index meanwhile; nothing is changed, start again");
}

MOTIONLANG_BODY void ShardStore::write() {
  require_same_list();
  if (open_ && open_->count() > 0) finished_.push_back(write_shard(*open_));
  open_.reset();
  ShardList next{.model = list_.model, .shard_bytes = list_.shard_bytes, .shards = {}};
  std::size_t first = 0;
  for (Index s = 0; s < std::ssize(list_.shards); ++s) {
    std::size_t end = first;
    while (end < origins_.size() && origins_[end].shard == s) ++end;
    if (!changed_[static_cast<std::size_t>(s)]) {
      next.shards.push_back(list_.shards[static_cast<std::size_t>(s)]);
    } else if (end > first) {
      next.shards.push_back(write_shard(changed_shard(s, std::span(clips_).subspan(first, end - first),
                                                      std::span(origins_).subspan(first, end - first))));
    }
    first = end;
  }
  next.shards.insert(next.shards.end(), finished_.begin(), finished_.end());
  const std::string path = (folder_ / shard_list_name).string(), text = detail::shard_list_text(next);
  std::optional<ShardList> now = detail::shard_list(text, path);
  std::vector<std::string> old = made_;
  if (published_) {
    for (const ShardEntry& e : published_->shards) old.push_back(e.file);
  }
  require_same_list();
  write_file(path, text);

  published_ = std::move(now), list_ = std::move(next);
  finished_.clear(), made_.clear();
  changed_.assign(list_.shards.size(), false);
  std::size_t i = 0;
  for (std::size_t s = 0; s < list_.shards.size(); ++s) {
    for (Index c = 0; c < list_.shards[s].clips; ++c, ++i)
      origins_[i].shard = static_cast<Index>(s), origins_[i].clip = c;
  }
  std::error_code none;
  for (const std::string& file : old) {
    const bool listed =
        std::any_of(list_.shards.begin(), list_.shards.end(), [&](const ShardEntry& e) { return e.file == file; });
    if (!listed) std::filesystem::remove(folder_ / file, none);
  }
}

MOTIONLANG_NAMESPACE_END
