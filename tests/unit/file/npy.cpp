// .npy and .npz: round trips, files as NumPy writes them, and files that must be refused.
#include <doctest/doctest.h>

#include <cstring>
#include <string>
#include <vector>

#include <motionlang/file/detail/deflate.hpp>
#include <motionlang/file/detail/inflate.hpp>
#include <motionlang/file/npz.hpp>

#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

namespace {

/// A .npy file with the given header text, padded as NumPy does.
std::vector<std::byte> file_with(std::string header, std::string_view data, int version = 1) {
  header.append(117 - header.size(), ' ');
  header += '\n';
  std::vector<std::byte> out;
  ml::detail::append_text(out, "\x93NUMPY");
  ml::detail::append_value(out, static_cast<char>(version));
  ml::detail::append_value(out, '\0');
  if (version == 1) {
    ml::detail::append_value(out, static_cast<std::uint16_t>(header.size()));
  } else {
    ml::detail::append_value(out, static_cast<std::uint32_t>(header.size()));
  }
  ml::detail::append_text(out, header);
  ml::detail::append_text(out, data);
  return out;
}
ml::NpyArray parse(const std::string& header, std::string_view data, int version = 1) {
  return ml::parse_npy(file_with(header, data, version), "test.npy");
}
template <class T>
std::string raw(std::initializer_list<T> values) {
  return std::string(reinterpret_cast<const char*>(values.begin()), sizeof(T) * values.size());
}

/// numpy.savez_compressed of poses zeros (3, 156), trans arange(9) / 4, gender b'male', mocap_frame_rate 120.
constexpr std::string_view deflated_npz =
    "UEsDBBQAAAAIAAAAIQCsCZZ3YgAAACAPAAAJABQAcG9zZXMubnB5AQAQACAPAAAAAAAAYgAAAAAAAACb7BfqGxDJyFDGUK2eklqcXKRupaBuk2"
    "ahrqOgnpZfVFKUmBefX5SSChJ3S8wpTgWKF2ckFqQC+RrGOgqGpmaaOgq1CmQCLoZRMApGwSgYBaNgFIyCUTAKRsEoGAWjYBAAAFBLAwQUAAAA"
    "CAAAACEAX+W9ZV8AAADIAAAACQAUAHRyYW5zLm5weQEAEADIAAAAAAAAAF8AAAAAAAAAm+wX6hsQychQxlCtnpJanFykbqWgbpNmoa6joJ6WX1"
    "RSlJgXn1+UkgoSd0vMKU4FihdnJBakAvkaxjoKxpo6CrUKZAMuBhRwwR5CP4DSL6D0Byj9BUr/gNJ/oDSDAwBQSwMEFAAAAAgAAAAhAICfSLxG"
    "AAAAhAAAAAoAFABnZW5kZXIubnB5AQAQAIQAAAAAAAAARgAAAAAAAACb7BfqGxDJyFDGUK2eklqcXKRupaBeE2yirqOgnpZfVFKUmBefX5SSCh"
    "J3S8wpTgWKF2ckFqQC+RqaOgq1ChQBrtzEnFQAUEsDBBQAAAAIAAAAIQDrAW7TRwAAAIgAAAAUABQAbW9jYXBfZnJhbWVfcmF0ZS5ucHkBABAA"
    "iAAAAAAAAABHAAAAAAAAAJvsF+obEMnIUMZQrZ6SWpxcpG6loG6TZqGuo6Cell9UUpSYF59flJIKEndLzClOBYoXZyQWpAL5Gpo6CrUKFAEuBj"
    "CIcwAAUEsBAhQDFAAAAAgAAAAhAKwJlndiAAAAIA8AAAkAAAAAAAAAAAAAAIABAAAAAHBvc2VzLm5weVBLAQIUAxQAAAAIAAAAIQBf5b1lXwAA"
    "AMgAAAAJAAAAAAAAAAAAAACAAZ0AAAB0cmFucy5ucHlQSwECFAMUAAAACAAAACEAgJ9IvEYAAACEAAAACgAAAAAAAAAAAAAAgAE3AQAAZ2VuZG"
    "VyLm5weVBLAQIUAxQAAAAIAAAAIQDrAW7TRwAAAIgAAAAUAAAAAAAAAAAAAACAAbkBAABtb2NhcF9mcmFtZV9yYXRlLm5weVBLBQYAAAAABAAE"
    "AOgAAABGAgAAAAA=";

}  // namespace

TEST_CASE_TEMPLATE("numbers come back", T, float, double, std::int8_t, std::int32_t, std::int64_t, std::uint8_t,
                   std::uint32_t) {
  const std::vector<T> values{T(0), T(1), T(2), T(3), T(100), T(127)};
  const auto array = ml::NpyArray::of(std::span<const T>(values), {3, 2});
  const auto back = ml::parse_npy(ml::npy_bytes(array), "memory");
  CHECK(back.kind == array.kind);
  CHECK(back.shape == array.shape);
  CHECK(back.template to<T>() == values);
  CHECK(back.template to<double>().back() == 127);
}

TEST_CASE("a file is the one that NumPy writes") {
  const auto bytes =
      ml::npy_bytes(ml::NpyArray::of(std::span<const float>(std::vector<float>{0, 1, 2, 3, 4, 5}), {2, 3}));
  CHECK(bytes.size() == 152);
  CHECK(bytes ==
        file_with("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }", raw<float>({0, 1, 2, 3, 4, 5})));
  CHECK(ml::detail::as_text(ml::npy_bytes(ml::NpyArray::scalar(2.5))).find("'shape': (), }") == 51);
  CHECK(ml::detail::as_text(ml::npy_bytes(ml::NpyArray::text("male"))).find("'<U4'") == 20);
  const std::int64_t one = 1;
  CHECK(ml::detail::as_text(ml::npy_bytes(ml::NpyArray::of(std::span(&one, 1), {1}))).find("(1,)") == 60);
}

TEST_CASE("the forms of the header that occur") {
  const std::vector<double> rows{0, 1, 2, 3, 4, 5};
  CHECK(parse("{'descr': '<f4', 'fortran_order': True, 'shape': (2, 3), }", raw<float>({0, 3, 1, 4, 2, 5}))
            .to<double>() == rows);
  CHECK(parse("{\"shape\":(2L, 3L),\"fortran_order\":False,\"descr\":\"<i2\"}", raw<std::int16_t>({0, 1, 2, 3, 4, 5}))
            .to<double>() == rows);
  CHECK(parse("{'descr': '>f8', 'fortran_order': False, 'shape': (2,), }",
              std::string_view("\x3F\xF8\0\0\0\0\0\0\xC0\0\0\0\0\0\0\0", 16))
            .to<double>() == std::vector<double>{1.5, -2});
  CHECK(parse("{'descr': '|b1', 'fortran_order': False, 'shape': (), }", "\x01").value<int>() == 1);
  CHECK(
      parse("{'descr': '<f2', 'fortran_order': False, 'shape': (1,), }", raw<std::uint16_t>({0x3555})).value<float>() ==
      0.333251953125f);
  CHECK(parse("{'descr': '<i8', 'fortran_order': False, 'shape': (2,), }", raw<std::int64_t>({0, 1}), 2)
            .to<std::uint8_t>() == std::vector<std::uint8_t>{0, 1});
  CHECK(parse("{'descr': '<f8', 'fortran_order': False, 'shape': (1,), }", raw<double>({7}), 3).value<double>() == 7);
  CHECK(parse("{'descr': '<f8', 'fortran_order': False, 'shape': (0, 3), }", "").to<double>().empty());
}

TEST_CASE("three axes in Fortran order") {
  // a[i][j][k] = 100 i + 10 j + k with sizes 2, 3, 2; the first index is the fastest in the file
  std::vector<std::int32_t> stored, expected;
  for (int k = 0; k < 2; ++k) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 2; ++i) stored.push_back(100 * i + 10 * j + k);
    }
  }
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 2; ++k) expected.push_back(100 * i + 10 * j + k);
    }
  }
  const std::string_view data(reinterpret_cast<const char*>(stored.data()), stored.size() * 4);
  CHECK(parse("{'descr': '<i4', 'fortran_order': True, 'shape': (2, 3, 2), }", data).to<std::int32_t>() == expected);
}

TEST_CASE("texts: fixed width, either byte order, not only ASCII") {
  for (const char* text : {"male", "", "Zürich", "跑步", "\U0001F3C3"}) {
    CHECK(ml::parse_npy(ml::npy_bytes(ml::NpyArray::text(text)), "memory").text() == text);
  }
  CHECK(parse("{'descr': '|S6', 'fortran_order': False, 'shape': (), }", std::string_view("male\0\0", 6)).text() ==
        "male");
  CHECK(parse("{'descr': '>U2', 'fortran_order': False, 'shape': (2,), }",
              std::string_view("\0\0\0a\0\0\0b\0\0\0c\0\0\0\0", 16))
            .texts() == std::vector<std::string>{"ab", "c"});
  CHECK(parse("{'descr': '<U1', 'fortran_order': False, 'shape': (), }", raw<std::uint32_t>({0xFFFFFFFFu})).text() ==
        "\uFFFD");
}

TEST_CASE("what does not fit is refused when it is asked for") {
  const auto one = ml::NpyArray::scalar(1.5);
  CHECK_THROWS_WITH_AS(one.to<int>(), doctest::Contains("407"), ml::io_error);
  CHECK_THROWS_WITH_AS(one.text(), doctest::Contains("407"), ml::io_error);
  CHECK_THROWS_WITH_AS(ml::NpyArray::text("a").to<double>(), doctest::Contains("407"), ml::io_error);
  CHECK_THROWS_WITH_AS(ml::NpyArray::scalar(std::int64_t{300}).to<std::uint8_t>(), doctest::Contains("300"),
                       ml::io_error);
  const std::vector<float> two{1, 2};
  CHECK_THROWS_WITH_AS(ml::NpyArray::of(std::span(two), {2}).value<float>(), doctest::Contains("407"), ml::io_error);
  CHECK_THROWS_WITH_AS(ml::NpyArray::of(std::span(two), {3}), doctest::Contains("205"), ml::shape_error);
}

TEST_CASE("what does not fit is refused with the file and the array") {
  const TemporaryFolder folder;
  const double pair[] = {1.5, 2};
  ml::write_npz(folder / "a.npz",
                std::vector<ml::NamedArray>{{"fps", ml::NpyArray::of(std::span<const double>(pair), {2})},
                                            {"gender", ml::NpyArray::text("male")}});
  const auto npz = ml::NpzArchive::open(folder / "a.npz");
  CHECK_THROWS_WITH_AS(npz.read("fps").value<double>(), doctest::Contains("a.npz/fps: "), ml::io_error);
  CHECK_THROWS_WITH_AS(npz.read("fps").to<int>(), doctest::Contains("a.npz/fps: "), ml::io_error);
  CHECK_THROWS_WITH_AS(npz.read("fps").texts(), doctest::Contains("a.npz/fps: "), ml::io_error);
  CHECK_THROWS_WITH_AS(npz.read("gender").to<float>(), doctest::Contains("a.npz/gender: "), ml::io_error);
}

TEST_CASE("hostile .npy files") {
  auto refused = [](const std::string& header, std::string_view data, const char* id) {
    CHECK_THROWS_WITH_AS(parse(header, data), doctest::Contains(id), ml::io_error);
  };
  refused("{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }", "1234567", "402");
  refused("{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }", "123456789", "403");
  refused("{'descr': '<f4', 'fortran_order': False, 'shape': (-2,), }", "", "byte 61");
  refused("{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999999999,), }", "", "403");
  refused("{'descr': '<f4', 'fortran_order': False, 'shape': (4294967296, 4294967296), }", "", "405");
  refused("{'descr': '<f4', 'fortran_order': False, 'shape': (4611686018427387904, 0, 8), }", "x", "403");
  refused("{'descr': '|O', 'fortran_order': False, 'shape': (), }", "", "404");
  refused("{'descr': '<c16', 'fortran_order': False, 'shape': (), }", "", "404");
  refused("{'descr': '?f4', 'fortran_order': False, 'shape': (), }", "1234", "404");
  refused("{'descr': '<f4x', 'fortran_order': False, 'shape': (), }", "1234", "404");
  refused("{'descr': '|S0', 'fortran_order': False, 'shape': (1000000000000,), }", "", "404");
  refused("{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (), }", "1234", "404");
  refused("{'descr': '<f4', 'fortran_order': False}", "1234", "403");
  refused("{'descr': '<f4', 'descr': '<f4', 'fortran_order': False}", "1234", "403");
  refused("{'descr': '<f4', 'fortran_order': Maybe, 'shape': ()}", "1234", "403");
  refused("{'descr': '<f4', 'fortran_order': False, 'shape': (), 'x': 'y'}", "1234", "403");
  refused("{'descr': '<f4', 'fortran_order': False, 'shape': ()} + evil()", "1234", "403");
  refused("{'descr': '<f4', 'fortran_order': False, 'shape': (1 1)}", "1234", "403");
  refused("{'descr': '<f4", "1234", "403");
  refused("no dictionary", "", "403");
  CHECK_THROWS_WITH_AS(parse("{}", "", 9), doctest::Contains("404"), ml::io_error);
  CHECK_THROWS_WITH_AS(ml::parse_npy({}, "empty"), doctest::Contains("403"), ml::io_error);
  const auto whole = ml::npy_bytes(ml::NpyArray::scalar(1.0));
  for (std::size_t n = 0; n < whole.size(); ++n) {
    CHECK_THROWS_AS(ml::parse_npy(std::span(whole).first(n), "cut"), ml::io_error);
  }
}

TEST_CASE("an archive comes back from disk") {
  const TemporaryFolder folder;
  const std::vector<double> trans{1, 2, 3, 4, 5, 6};
  const std::vector<ml::NamedArray> arrays{{"trans", ml::NpyArray::of(std::span(trans), {2, 3})},
                                           {"gender", ml::NpyArray::text("neutral")}};
  ml::write_npz(folder / "a.npz", arrays);
  const auto npz = ml::NpzArchive::open(folder / "a.npz");
  CHECK(npz.names() == std::vector<std::string>{"trans", "gender"});
  CHECK(npz.read("trans").to<double>() == trans);
  CHECK(npz.read("gender").text() == "neutral");
  CHECK_FALSE(npz.has("poses"));
  CHECK_THROWS_WITH_AS(npz.read("poses"), doctest::Contains("406"), ml::io_error);
  CHECK_THROWS_WITH_AS(ml::NpzArchive::open(folder / "b.npz"), doctest::Contains("401"), ml::io_error);
  ml::write_npy(folder / "t.npy", arrays[0].array);
  CHECK(ml::read_npy(folder / "t.npy").to<double>() == trans);
}

TEST_CASE("an archive that NumPy compressed") {
  const auto bytes = ml::detail::from_base64(deflated_npz);
  const ml::NpzArchive npz(ml::ZipArchive(bytes, "numpy.npz"));
  CHECK(npz.read("poses").shape == std::vector<ml::Index>{3, 156});
  CHECK(npz.read("poses").to<double>() == std::vector<double>(3 * 156, 0.0));
  CHECK(npz.read("trans").to<double>() == std::vector<double>{0, 0.25, 0.5, 0.75, 1, 1.25, 1.5, 1.75, 2});
  CHECK(npz.read("gender").text() == "male");
  CHECK(npz.read("mocap_frame_rate").value<double>() == 120);
}

TEST_CASE("a large compressed array is not unpacked unless its header wants so much") {
  const std::vector<float> zeros(1 << 20);
  const auto archive = [&](ml::Index declared) {
    auto npy = ml::npy_bytes({'f', 4, {declared}, {}});
    ml::detail::append_bytes(npy, std::as_bytes(std::span(zeros)));
    const std::string packed = ml::detail::deflate(npy);
    ml::ZipWriter zip;
    zip.add("a.npy", std::as_bytes(std::span(packed)));
    auto bytes = zip.finish();
    const auto put = [&bytes](std::size_t at, auto value) { std::memcpy(bytes.data() + at, &value, sizeof value); };
    const std::size_t entry = 30 + 5 + packed.size();  // of the directory, behind the header, the name and the data
    put(entry + 10, std::uint16_t{8});
    put(entry + 16, ml::detail::crc32(npy));
    put(entry + 24, static_cast<std::uint32_t>(npy.size()));
    return bytes;
  };
  const auto honest = archive(std::ssize(zeros));
  CHECK(honest.size() < 50'000);
  CHECK(ml::NpzArchive(ml::ZipArchive(honest, "a.npz")).read("a").to<float>() == zeros);
  const auto refused = [](std::vector<std::byte> bytes, const char* text) {
    bytes[1000] ^= std::byte{0xFF};  // far behind the header: who unpacks it all meets it
    CHECK_THROWS_WITH_AS(ml::NpzArchive(ml::ZipArchive(bytes, "a.npz")).read("a"), doctest::Contains(text),
                         ml::io_error);
  };
  refused(archive(10), "a.npz/a: npy at byte 10: 4194264 bytes after the array data");
  refused(archive(1'000'000'000), "a.npz/a: npy at byte 10: array data of 4194304 bytes, 4000000000 needed");
}
