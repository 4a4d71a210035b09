// Folders of index shards: any list and any bytes of a shard are read or refused with an error of the library. What is
// read can be searched. What passes the check of every byte finds what one index of all clips finds, and can be changed
// and written again. An input changes a folder with one right shard, in one of these forms:
//     {...              the list, up to a byte 0 if there is one; then as in the last form
//     =...              the bytes of the shard; the list has its size, and the checksum and counts that it says
//     any other first   three bytes each: a place in the shard (two bytes) and the byte that is there instead
//     byte
// Files reach the disk before they have their names, so TMPDIR=/dev/shm makes it several times as fast.
#include <cmath>
#include <cstdint>

#include <motionlang/search/index_shards.hpp>
#include <motionlang/search/motion_search.hpp>

#include "../support/temporary_folder.hpp"
#include "check.hpp"

namespace {

namespace ml = motionlang;
using ml::Index;

/// A clip with its vector at an angle, moments, and captions.
ml::EncodedClip clip_at(const std::string& path, float angle, const ml::IndexModel& model, int captions) {
  const auto append = [](std::vector<float>& to, float a) { to.insert(to.end(), {std::cos(a), std::sin(a)}); };
  ml::EncodedClip out{.clip = {.path = path, .modified = 7, .bytes = 9, .end = 3, .fps = 20, .frames = 60},
                      .vector = {}};
  append(out.vector, angle);
  out.moments = ml::indexed_moments(60, model);
  for (std::size_t i = 0; i < out.moments.size(); ++i) append(out.moment_vectors, angle + 0.1F * static_cast<float>(i));
  for (int c = 0; c < captions; ++c) {
    out.clip.captions.push_back("caption " + std::to_string(c));
    append(out.caption_vectors, angle - 0.2F * static_cast<float>(c));
  }
  return out;
}

/// The folder that inputs change, and its right files.
struct Place : TemporaryFolder {
  ml::IndexModel model{
      .id = "0123456789abcdef", .path = "model", .width = 2, .fps = 20, .windows = {20, 40}, .stride = 20};
  std::string list, shard, name;
  ml::ShardEntry entry;

  Place() {
    ml::ShardStore store(*this / "shards", model, Index{64} << 10);
    for (int i = 0; i < 3; ++i) store.add(clip_at("clip" + std::to_string(i), static_cast<float>(i), model, i));
    store.write();
    entry = ml::read_shard_list(*this / "shards").shards.front();
    name = entry.file;
    list = ml::read_file(*this / "shards/shards.json");
    shard = ml::read_file(*this / ("shards/" + name));
  }
  void write(std::string_view list_text, std::string_view shard_bytes) const {
    std::filesystem::remove_all(*this / "shards");
    std::filesystem::create_directories(*this / "shards");
    ml::write_file(*this / "shards/shards.json", list_text);
    ml::write_file(*this / ("shards/" + name), shard_bytes);
  }
  /// The right list, with what these bytes say about themselves.
  std::string list_of(std::string_view bytes) const {
    std::string out = list;
    const auto set = [&](const std::string& key, const auto& before, const auto& now) {
      const std::string text = ml::concat_text('"', key, "\": ", before);
      out.replace(out.rfind(text), text.size(), ml::concat_text('"', key, "\": ", now));
    };
    set("bytes", entry.bytes, std::ssize(bytes));
    refusing([&] {
      const auto file = ml::SafetensorsFile::from_bytes(std::as_bytes(std::span(bytes)));
      const auto sum = file.metadata().find("checksum");
      if (sum != file.metadata().end() && sum->second.find_first_not_of("0123456789abcdef") == std::string::npos)
        set("checksum", '"' + entry.checksum + '"', '"' + sum->second + '"');
      const auto rows = [&](const char* tensor, Index before) {
        const ml::TensorView* t = file.find(tensor);
        if (t != nullptr && t->shape.rank() > 0) set(tensor, before, t->shape[0]);
      };
      rows("clips", entry.clips), rows("moments", entry.moments), rows("captions", entry.captions);
    });
    return out;
  }
};

std::string changed(std::string bytes, std::string_view by) {
  for (; by.size() >= 3; by.remove_prefix(3)) {
    const auto at =
        static_cast<std::size_t>(static_cast<unsigned char>(by[0])) << 8 | static_cast<unsigned char>(by[1]);
    bytes[at % bytes.size()] = by[2];
  }
  return bytes;
}

/// The answers, in which every hit is a clip of the index.
struct Answers {
  std::vector<ml::MotionHit> clips, moments, captions;
  bool operator==(const Answers&) const = default;

  Answers(const ml::MotionSearch& search, const ml::IndexModel& model, Index count) {
    const std::vector<float> query{0.5F, 1};
    clips = search.clips(query, 2), captions = search.captions(query, 2);
    if (!model.windows.empty()) moments = search.moments(query, 3);
    for (const auto* hits : {&clips, &moments, &captions}) {
      for (const ml::MotionHit& hit : *hits) check(hit.clip >= 0 && hit.clip < count, "hits are of clips");
    }
  }
};

void check_folder(const std::filesystem::path& folder) {
  const auto shards = ml::IndexShards::open(folder);
  const Index count = shards->clip_count();
  if (shards->model().width != 2) return;
  const auto answers = [&] { return Answers(ml::open_motion_search(shards), shards->model(), count); };
  refusing([&] { answers(); });
  refusing([&] {
    for (Index i = 0; i < std::min<Index>(count, 100); ++i) shards->clip(i);
    for (Index i = 0; i < std::min<Index>(shards->moment_count(), 100); ++i)
      check(shards->moment(i).clip < count, "moments are of clips");
    for (Index i = 0; i < std::min<Index>(shards->caption_count(), 100); ++i)
      check(shards->clip_of_caption(i) < count, "captions are of clips");
  });
  shards->check();
  const ml::MotionIndex whole = shards->whole();
  check(whole.count() == count, "the whole index has all clips");
  check(answers() == Answers(ml::MotionSearch(whole), whole.model(), count), "shards find what one index finds");

  ml::ShardStore store(folder);
  std::vector<bool> gone(static_cast<std::size_t>(count));
  if (count > 1) gone[1] = true;
  store.remove(gone);
  store.add(clip_at("a new clip", 2.5F, shards->model(), 1));
  store.write();
  const auto again = ml::IndexShards::open(folder);
  again->check();
  check(again->clip_count() == count - (count > 1 ? 1 : 0) + 1, "a changed folder has the changed clips");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Place place;
  std::string_view input(reinterpret_cast<const char*>(data), size);
  if (input.starts_with('{')) {
    const std::string_view list = input.substr(0, input.find('\0'));
    place.write(list, changed(place.shard, input.substr(std::min(input.size(), list.size() + 1))));
  } else if (input.starts_with('=')) {
    const std::string_view bytes = input.substr(1);
    place.write(place.list_of(bytes), bytes);
  } else {
    const std::string shard = changed(place.shard, input.substr(std::min<std::size_t>(1, input.size())));
    place.write(place.list_of(shard), shard);
  }
  refusing([&] { check_folder(place / "shards"); });
  return 0;
}
