// Deflate and PNG: what is packed unpacks to the same, the parts of the file, what is refused.
#include <doctest/doctest.h>

#include <motionlang/core/rng.hpp>
#include <motionlang/file/detail/deflate.hpp>
#include <motionlang/file/detail/inflate.hpp>
#include <motionlang/file/png.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;

namespace {

std::string there_and_back(const std::string& text) {
  const std::string packed = ml::detail::deflate(std::as_bytes(std::span(text)));
  const auto out = ml::detail::inflate(std::as_bytes(std::span(packed)), text.size(), "test");
  CHECK(out.consumed == packed.size());
  return std::string(ml::detail::as_text(out.data));
}

}  // namespace

TEST_CASE("deflate: what is packed unpacks to the same") {
  ml::Philox rng{.seed = 5};
  for (const std::string& text : {std::string(), std::string("a"), std::string("abcabcabcabcx"),
                                  std::string(100000, '\0'), std::string("\x8f\x90\xff") + std::string(300, 'z')}) {
    CHECK(there_and_back(text) == text);
  }
  // matches of every length and of distances up to the farthest, and beyond
  std::string mixed;
  for (int i = 0; i < 60000; ++i) mixed += static_cast<char>(rng.below(256));
  for (int i = 0; i < 3000; ++i) {
    const std::size_t from = rng.below(static_cast<std::uint32_t>(mixed.size()) - 300);
    mixed += mixed.substr(from, 3 + rng.below(256));
  }
  CHECK(there_and_back(mixed) == mixed);
  for (std::size_t length = 3; length <= 258; ++length) {
    const std::string text = mixed.substr(0, 300) + mixed.substr(0, length) + "\x01";
    REQUIRE(there_and_back(text) == text);
  }
  const std::string flat(1 << 20, ' ');
  CHECK(ml::detail::deflate(std::as_bytes(std::span(flat))).size() < flat.size() / 100);
}

TEST_CASE("PNG: parts with their checksums, rows as differences") {
  const ml::Picture picture{2, 3, {255, 0, 0, 0, 255, 0, 250, 1, 0, 0, 0, 255, 9, 9, 9, 7, 7, 7}};
  const std::string png = ml::encode_png(picture);
  CHECK(png.starts_with("\x89PNG\r\n\x1a\n"));
  CHECK(png.substr(8, 8) == std::string("\0\0\0\x0dIHDR", 8));
  CHECK(png.substr(16, 13) == std::string("\0\0\0\2\0\0\0\3\x08\2\0\0\0", 13));
  CHECK(png.ends_with(std::string("\0\0\0\0IEND\xAE\x42\x60\x82", 12)));
  const std::size_t data = png.find("IDAT") + 4, end = png.size() - 12 - 4;
  const auto stream = std::as_bytes(std::span(png)).subspan(data + 2, end - data - 6);
  const auto rows = ml::detail::inflate(stream, 100, "png").data;
  std::vector<int> decoded, above(6, 0);
  REQUIRE(rows.size() == 3 * 7);
  for (std::size_t y = 0; y < 3; ++y) {
    CHECK(rows[7 * y] == std::byte{2});
    for (std::size_t x = 0; x < 6; ++x) {
      above[x] = (above[x] + std::to_integer<int>(rows[7 * y + 1 + x])) & 255;
      decoded.push_back(above[x]);
    }
  }
  CHECK(decoded == std::vector<int>(picture.rgb.begin(), picture.rgb.end()));
  CHECK(ml::detail::adler32(std::as_bytes(std::span("Wikipedia", 9))) == 0x11E60398);
  CHECK_ERROR(ml::encode_png({2, 2, {1, 2, 3}}), "[motionlang.shape.205] encode_png: 3 numbers for 2 x 2");
  CHECK_ERROR(ml::encode_png({0, 2, {}}), "[motionlang.config.101] encode_png: 0 x 2");
}
