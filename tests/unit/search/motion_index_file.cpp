// Index files: what is written is read, and a file that was cut off or changed is refused.
#include <doctest/doctest.h>

#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/search/motion_index_file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/indexed_motions.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using synthetic::acted_clip;

namespace {

ml::MotionIndex some_clips() {
  ml::MotionIndex index(synthetic::action_model({10}, 5));
  auto c = acted_clip("clips/a \"b\".bvh", {{0, 12}, {3, 9}}, index.model(), {0, 3});
  c.clip.name = "wave", c.clip.license = "CC0 1.0", c.clip.start = 0.25;
  index.add(c);
  index.add(acted_clip("clips/ä.glb", {{1, 7}}, index.model()));
  return index;
}

void check_same(const ml::MotionIndex& a, const ml::MotionIndex& b) {
  CHECK(a.model() == b.model());
  CHECK(std::equal(a.clips().begin(), a.clips().end(), b.clips().begin(), b.clips().end()));
  CHECK(std::equal(a.moments().begin(), a.moments().end(), b.moments().begin(), b.moments().end()));
  CHECK(std::equal(a.clip_rows().begin(), a.clip_rows().end(), b.clip_rows().begin(), b.clip_rows().end()));
  CHECK(std::equal(a.moment_rows().begin(), a.moment_rows().end(), b.moment_rows().begin(), b.moment_rows().end()));
  CHECK(std::equal(a.caption_rows().begin(), a.caption_rows().end(), b.caption_rows().begin(), b.caption_rows().end()));
}

}  // namespace

TEST_CASE("index files: there and back, with what else is in them; vectors lie in the file") {
  const TemporaryFolder folder;
  const auto index = some_clips();
  ml::write_motion_index(folder / "index", index, {{"graph_clips", std::vector<std::byte>(5, std::byte{7})}});
  const auto file = ml::MotionIndexFile::open(folder / "index");
  check_same(file.index(), index);
  CHECK(file.extra("graph_clips").size() == 5);
  CHECK(file.extra("graph_moments").empty());
  const auto tensors = ml::SafetensorsFile::open(folder / "index");  // for other programs
  CHECK(tensors.tensor("clips").shape == ml::Shape{2, 9});
  CHECK(tensors.tensor("moment_frames").dtype == ml::DType::I64);

  auto changed = ml::read_motion_index(folder / "index");  // the mapped rows stay while the file is replaced
  changed.add(acted_clip("new.bvh", {{5, 30}}, changed.model()));
  changed.remove_if([](const auto& c) { return c.path == "clips/ä.glb"; });
  ml::write_motion_index(folder / "index", changed);
  check_same(file.index(), index);
  check_same(ml::read_motion_index(folder / "index"), changed);
}

TEST_CASE("index files: without clips") {
  const ml::MotionIndex index(synthetic::action_model({}, 0));
  const auto bytes = ml::motion_index_bytes(index);
  check_same(ml::MotionIndexFile::from_bytes(bytes).index(), index);
}

TEST_CASE("index files: cut off anywhere, or with any byte changed, they are refused") {
  const auto bytes = ml::motion_index_bytes(some_clips());
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    CHECK_THROWS_AS(ml::MotionIndexFile::from_bytes(std::span(bytes).first(n)), ml::error);
  }
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (const unsigned bit : {1u, 128u}) {
      auto other = bytes;
      other[i] ^= static_cast<std::byte>(bit);
      try {
        ml::MotionIndexFile::from_bytes(other);
        // Only blanks of the header can change without an error, and they mean nothing.
        CHECK_MESSAGE(std::to_integer<char>(bytes[i]) == ' ', "byte " << i);
      } catch (const ml::error&) {}
    }
  }
}

TEST_CASE("index files: what says wrong things about itself") {
  const auto index = some_clips();
  const auto with = [&](auto change) {  // tensors and metadata are changed, the checksum is right
    const auto bytes = ml::motion_index_bytes(index);
    const auto file = ml::SafetensorsFile::from_bytes(bytes);
    std::map<std::string, ml::TensorView> tensors;
    for (const auto& t : file.tensors()) tensors.emplace(t.name, t);
    auto metadata = file.metadata();
    std::vector<std::byte> memory;
    change(tensors, metadata, memory);
    std::vector<ml::TensorView> list;
    for (const auto& [name, t] : tensors) list.push_back(t);
    if (metadata.contains("checksum")) metadata["checksum"] = ml::tensors_checksum(list);
    const auto made = ml::safetensors_bytes(list, metadata);
    ml::MotionIndexFile::from_bytes(made, "x.index");
  };
  const auto about = [&](const std::string& from, const std::string& to) {
    with([&](auto& tensors, auto&, auto& memory) {
      auto& t = tensors.at("about");
      std::string text(ml::detail::as_text(t.bytes));
      REQUIRE(text.find(from) != text.npos);
      text.replace(text.find(from), from.size(), to);
      const auto bytes = std::as_bytes(std::span(text));
      memory.assign(bytes.begin(), bytes.end());
      t.bytes = memory, t.shape = {std::ssize(memory)};
    });
  };
  CHECK_ERROR(with([](auto&, auto& m, auto&) { m.erase("format"); }),
              "[motionlang.io.403] x.index: not an index of motionlang");
  CHECK_ERROR(with([](auto&, auto& m, auto&) { m["version"] = "9"; }),
              "[motionlang.io.404] x.index: version 9 of an index, expected 1");
  CHECK_ERROR(with([](auto&, auto& m, auto&) { m.erase("checksum"); }), "[motionlang.io.403] x.index: damaged");
  CHECK_ERROR(with([](auto& t, auto&, auto&) { t.erase("moments"); }), "[motionlang.io.406]");
  CHECK_ERROR(with([](auto& t, auto&, auto&) { t.at("clips").dtype = ml::DType::I32; }),
              "[motionlang.io.407] x.index: 'clips' is I32");
  CHECK_ERROR(with([](auto& t, auto&, auto&) { t.at("clips").shape = {9, 2}; }), "[motionlang.io.407]");
  CHECK_ERROR(with([](auto& t, auto&, auto&) { t.at("about").dtype = ml::DType::I8; }), "'about' is I8, not U8");
  CHECK_ERROR(with([](auto& t, auto&, auto&) {
                std::swap(t.at("clips").bytes, t.at("captions").bytes);
                std::swap(t.at("clips").shape, t.at("captions").shape);
                t.at("clips").bytes = {};
                t.at("clips").shape = {0, 9};
              }),
              "[motionlang.io.403] x.index: 2 clips, but 0 numbers for vectors of 9");
  CHECK_ERROR(with([](auto& t, auto&, auto& memory) {
                memory.assign(t.at("clips").bytes.begin(), t.at("clips").bytes.end());
                memory[3] = std::byte{0x7F};
                t.at("clips").bytes = memory;
              }),
              "[motionlang.numeric.302] x.index: vector 0 of 2 is not of length 1");
  CHECK_ERROR(with([](auto& t, auto&, auto& memory) {  // a clip that there is not
                memory.assign(t.at("moment_frames").bytes.begin(), t.at("moment_frames").bytes.end());
                memory[memory.size() - 24] = std::byte{2};
                t.at("moment_frames").bytes = memory;
              }),
              "of clip 2 among 2");
  CHECK_ERROR(about("\"path\":\"clips", "\"pth\":\"clips"),
              "[motionlang.config.107] x.index: about: clips[0]: has no member 'path'");
  CHECK_ERROR(about("\"width\":9", "\"width\":8"), "[motionlang.io.407]");
  CHECK_ERROR(about("\"width\":9", "\"width\":-1"), "[motionlang.");
  CHECK_ERROR(about("\"fps\":20.0", "\"fps\":0"), "[motionlang.config.101]");
  CHECK_ERROR(about("{", "["), "[motionlang.io.403] x.index: about:1:");
}
