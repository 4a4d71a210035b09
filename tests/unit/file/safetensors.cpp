// safetensors: reading, refusing, writing. Files of other programs are read by the golden cases.
#include <doctest/doctest.h>

#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/safetensors.hpp>

#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using ml::DType, ml::SafetensorsFile, ml::Shape, ml::TensorView;

namespace {

std::string file_of(std::string_view header, std::string_view data, std::uint64_t length) {
  return std::string(reinterpret_cast<const char*>(&length), 8) + std::string(header) + std::string(data);
}
std::string file_of(std::string_view header, std::string_view data = "") {
  return file_of(header, data, header.size());
}

SafetensorsFile read(const std::string& bytes) {
  return SafetensorsFile::from_bytes(std::as_bytes(std::span(bytes)), "test");
}

/// The message of the refusal, or "accepted".
std::string refusal(const std::string& bytes) {
  try {
    read(bytes);
    return "accepted";
  } catch (const ml::io_error& e) {
    return e.what();
  }
}

void check_refused(const std::string& bytes, const std::string& beginning) {
  CHECK_MESSAGE(refusal(bytes).starts_with("[motionlang.io." + beginning), refusal(bytes), " should be ", beginning,
                ": ", bytes.substr(8));
}

/// A header with one tensor "a".
std::string one(std::string_view dtype, std::string_view shape, std::string_view offsets) {
  return ml::concat_text("{\"a\":{\"dtype\":\"", dtype, "\",\"shape\":", shape, ",\"data_offsets\":", offsets, "}}");
}

}  // namespace

TEST_CASE("a small file, byte by byte") {
  const auto bytes = ml::detail::from_base64(
      "kAAAAAAAAAB7Il9fbWV0YWRhdGFfXyI6eyJmb3JtYXQiOiJwdCJ9LCJiIjp7ImR0eXBlIjoiRjMyIiwic2hhcGUiOlszXSwiZGF0YV9vZmZz"
      "ZXRzIjpbMCwxMl19LCJhIjp7ImR0eXBlIjoiQkYxNiIsInNoYXBlIjpbMl0sImRhdGFfb2Zmc2V0cyI6WzEyLDE2XX19ICAAAIA/AAAgwAAA"
      "UECAPyDA");
  const auto file = SafetensorsFile::from_bytes(bytes);
  CHECK(file.names() == std::vector<std::string>{"a", "b"});
  CHECK(file.metadata() == std::map<std::string, std::string>{{"format", "pt"}});
  CHECK(file.tensor("a").dtype == DType::BF16);
  CHECK(ml::values_of<float>(file.tensor("a")) == std::vector<float>{1, -2.5});
  CHECK(ml::values_of<double>(file.tensor("b")) == std::vector<double>{1, -2.5, 3.25});
  CHECK(file.tensor("b").shape == Shape{3});
  CHECK(file.find("c") == nullptr);
  CHECK_THROWS_WITH_AS(file.tensor("c"), doctest::Contains("[motionlang.io.406]"), ml::io_error);
  const auto named = read(file_of(R"({"layers.0.weight":{"dtype":"U8","shape":[1],"data_offsets":[0,1]}})", "x"));
  CHECK_THROWS_WITH_AS(named.tensor("layers.0.wieght"),
                       "[motionlang.io.406] test: no tensor 'layers.0.wieght' among 1; the file has 'layers.0.weight'",
                       ml::io_error);
  CHECK_THROWS_WITH_AS(named.tensor("bias"), "[motionlang.io.406] test: no tensor 'bias' among 1", ml::io_error);

  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  check_refused(text.substr(0, text.size() - 1), "402] test: byte");
  check_refused(text + "x", "403] test: byte 8: 1 byte of data belongs to no tensor");
}

TEST_CASE("small files that are fine") {
  CHECK(read(file_of("{}")).tensors().empty());
  CHECK(read(file_of("{} \n\t\r ")).tensors().empty());
  CHECK(read(file_of(one("F32", "[]", "[0,4]"), "abcd")).tensor("a").shape == Shape{});
  CHECK(read(file_of(one("F32", "[2,0]", "[0,0]"))).tensor("a").bytes.empty());
  CHECK(read(file_of(R"({ "a" : { "data_offsets" : [ 0 , 1 ] , "shape" : [ 1 ] , "dtype" : "U8" } })", "x"))
            .tensors()
            .size() == 1);
  const auto extra = read(
      file_of(R"({"a":{"dtype":"U8","shape":[1],"data_offsets":[0,1],"x":[-0.5e+3,true,false,null,{"y":""}]}})", "x"));
  CHECK(extra.tensors().size() == 1);
  const auto escapes = read(file_of(R"({"__metadata__":{"\u00e9\ud83d\ude00":"\"\\\/\b\f\n\r\t"}})"));
  CHECK(escapes.metadata().at("\xC3\xA9\xF0\x9F\x98\x80") == "\"\\/\b\f\n\r\t");
}

TEST_CASE("files that end too early") {
  check_refused("", "402] test: ends inside the header length");
  check_refused("1234567", "402]");
  check_refused(file_of("{}", "", 3), "402] test: the header needs 3 bytes");
  check_refused(file_of("{}", "", 1000), "402]");
  check_refused(file_of(one("U8", "[5]", "[0,5]"), "1234"), "402] test: byte 13: tensor 'a' ends at 5");
}

TEST_CASE("sizes that cannot be") {
  check_refused(file_of("{}", "", ~std::uint64_t{0}), "405]");
  check_refused(file_of("{}", "", 100'000'001), "405]");
  check_refused(file_of(one("I32", "[2,2]", "[0,4]"), "1234"), "405]");
  check_refused(file_of(one("U8", "[2]", "[2,0]"), "12"), "405]");
  check_refused(file_of(one("U8", "[2,18446744073709551614]", "[0,4]"), "1234"), "405]");
  check_refused(file_of(one("U8", "[2,9223372036854775807]", "[0,4]"), "1234"), "405]");
  check_refused(file_of(one("F64", "[1152921504606846976]", "[0,0]")), "405]");
  check_refused(file_of(one("U8", "[4611686018427387904,4,0]", "[0,0]")), "405]");  // the product without the 0
  check_refused(file_of(one("F4", "[3]", "[0,1]"), "1"), "405]");                   // 12 bits are not whole bytes
}

TEST_CASE("ranges that do not tile the data") {
  const auto two = [](std::string_view first, std::string_view second) {
    return file_of(ml::concat_text(R"({"a":{"dtype":"U8","shape":[2],"data_offsets":)", first,
                                   R"(},"b":{"dtype":"U8","shape":[2],"data_offsets":)", second, "}}"),
                   "12345");
  };
  check_refused(two("[0,2]", "[0,2]"), "403] test: byte");
  check_refused(two("[0,2]", "[1,3]"), "403]");
  check_refused(two("[0,2]", "[3,5]"), "403]");
  check_refused(two("[1,3]", "[3,5]"), "403]");
  check_refused(two("[0,2]", "[2,4]"), "403]");  // one byte left over
  CHECK(refusal(two("[0,2]", "[3,5]")).find("leave a hole after byte 2") != std::string::npos);
  CHECK(refusal(two("[2,4]", "[1,3]")).find("overlap") == std::string::npos);  // the first hole is reported
  CHECK(refusal(two("[0,2]", "[1,3]")).find("overlap the range before, which ends at 2") != std::string::npos);
}

TEST_CASE("headers that are not the JSON that is due") {
  for (const char* header : {"",
                             "{",
                             "[]",
                             "1",
                             "\xFF",
                             " {}",
                             "{}}",
                             "{} x",
                             "{\"a\"}",
                             "{\"a\":1}",
                             "{\"a\":{}}",
                             "{\"a\":{},}",
                             "{a:{}}",
                             R"({"__metadata__":{"a":1}})",
                             R"({"__metadata__":[]})",
                             R"({"__metadata__":{},"__metadata__":{}})",
                             R"({"__metadata__":{"a":"","a":""}})",
                             R"({"__metadata__":{"a":"\ud800"}})",
                             R"({"__metadata__":{"a":"\x"}})",
                             R"({"__metadata__":{"a":"\u12g4"}})",
                             "{\"__metadata__\":{\"a\":\"\n\"}}",
                             R"({"__metadata__":{"a":"b)",
                             R"({"__metadata__":{"a":"\udc00"}})",
                             R"({"__metadata__":{"a":"\ud800\u0041"}})",
                             "{\"\xC3(\":{}}"}) {
    check_refused(file_of(header), "403] test: byte");
  }
  for (const char* member :
       {R"("shape":[1],"data_offsets":[0,1])", R"("dtype":"U8","data_offsets":[0,1])", R"("dtype":"U8","shape":[1])",
        R"("dtype":"U8","shape":[1],"data_offsets":[0])", R"("dtype":"U8","shape":[1],"data_offsets":[0,1,1])",
        R"("dtype":"U8","dtype":"U8","shape":[1],"data_offsets":[0,1])",
        R"("dtype":"U8","shape":[1],"data_offsets":[0,1],"x":{"y":1,"y":2})",
        R"("dtype":"U8","shape":[1],"data_offsets":[0,1],"x":[[[1]]])",
        R"("dtype":"U8","shape":[1],"data_offsets":[0,1],"x":01)",
        R"("dtype":"U8","shape":[1],"data_offsets":[0,1],"x":+1)",
        R"("dtype":"U8","shape":[1],"data_offsets":[0,1],"x":1.)",
        R"("dtype":"U8","shape":[1],"data_offsets":[0,1],"x":tru)", R"("dtype":8,"shape":[1],"data_offsets":[0,1])",
        R"("dtype":"U8","shape":1,"data_offsets":[0,1])"}) {
    check_refused(file_of(ml::concat_text("{\"a\":{", member, "}}"), "x"), "403] test: byte");
  }
  for (const char* number : {"-1", "-0", "1.0", "1e0", "1E0", "\"1\"", "01", "null", "+1", "x"}) {
    check_refused(file_of(one("U8", ml::concat_text("[", number, "]"), "[0,1]"), "x"), "403] test: byte");
    check_refused(file_of(one("U8", "[1]", ml::concat_text("[0,", number, "]")), "x"), "403] test: byte");
  }
  CHECK(refusal(file_of(R"({"ab":{"dtype":"U8","shape":[],"data_offsets":[0,1]},"ab":{}})", "x")) ==
        "[motionlang.io.403] test: byte 61: the name 'ab' is duplicated in one object");
}

TEST_CASE("what is not supported says so") {
  check_refused(file_of(one("F31", "[1]", "[0,4]"), "1234"), "404] test: byte 22: unknown dtype 'F31'");
  const auto ones = [](int count) {
    std::string shape = "[1";
    for (int i = 1; i < count; ++i) shape += ",1";
    return file_of(one("U8", shape + "]", "[0,1]"), "1");
  };
  CHECK(read(ones(64)).tensor("a").shape.rank() == 64);
  check_refused(ones(65), "404]");
  const std::string eight_bits = file_of(one("F8_E4M3", "[2]", "[0,2]"), "12");
  const auto file = read(eight_bits);  // known, and of the right size
  CHECK_THROWS_WITH_AS(ml::values_of<float>(file.tensor("a")), doctest::Contains("[motionlang.io.404]"), ml::io_error);
}

TEST_CASE("2 GB that are not there are refused at once and in no memory") {
  const TemporaryFolder folder;
  const auto path = folder / "sparse.safetensors";
  for (const auto& start : {file_of("", "", 99'999'999), file_of("{", "", 99'999'999), file_of("", "", 0x7FFFFFF0),
                            file_of("{\"a\":", "", 99'999'999)}) {
    ml::write_file(path, start);
    std::filesystem::resize_file(path, std::uintmax_t{2} << 30);
    rusage before{}, after{};
    ::getrusage(RUSAGE_SELF, &before);
    const auto begin = std::chrono::steady_clock::now();
    CHECK_THROWS_AS(SafetensorsFile::open(path), ml::io_error);
    const auto time = std::chrono::steady_clock::now() - begin;
    ::getrusage(RUSAGE_SELF, &after);
    CHECK(time < std::chrono::milliseconds(10));
    CHECK(after.ru_maxrss - before.ru_maxrss < 1024);  // kilobytes
  }
}

TEST_CASE("values of all types, converted") {
  const std::string bytes = file_of(
      R"({"bool":{"dtype":"BOOL","shape":[2],"data_offsets":[0,2]},"f16":{"dtype":"F16","shape":[2],"data_offsets":[2,6]},)"
      R"("i16":{"dtype":"I16","shape":[1],"data_offsets":[6,8]},"i8":{"dtype":"I8","shape":[1],"data_offsets":[8,9]},)"
      R"("u64":{"dtype":"U64","shape":[1],"data_offsets":[9,17]},"f32":{"dtype":"F32","shape":[1],"data_offsets":[17,21]}})",
      std::string_view("\0\2\0\x3C\0\xC1\xFE\xFF\x80\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF\0\0\x80\x3F", 21));
  const auto file = read(bytes);
  CHECK(ml::values_of<int>(file.tensor("bool")) == std::vector<int>{0, 1});
  CHECK(ml::values_of<float>(file.tensor("f16")) == std::vector<float>{1, -2.5});
  CHECK(ml::values_of<ml::Index>(file.tensor("i16")) == std::vector<ml::Index>{-2});
  CHECK(ml::values_of<double>(file.tensor("i8")) == std::vector<double>{-128});
  CHECK(ml::values_of<std::uint64_t>(file.tensor("u64")) == std::vector<std::uint64_t>{~std::uint64_t{0}});
  CHECK(ml::values_of<float>(file.tensor("f32")) == std::vector<float>{1});  // not aligned
  CHECK_THROWS_WITH_AS(ml::values_of<int>(file.tensor("f32")), doctest::Contains("[motionlang.io.407]"), ml::io_error);
  CHECK_THROWS_WITH_AS(ml::values_of<ml::Index>(file.tensor("u64")), doctest::Contains("[motionlang.io.407]"),
                       ml::io_error);
  CHECK_THROWS_AS(ml::values_of<std::uint8_t>(file.tensor("i16")), ml::io_error);
  std::vector<float> three(3);
  CHECK_THROWS_WITH_AS(ml::copy_values(file.tensor("f16"), std::span<float>(three)),
                       doctest::Contains("[motionlang.shape.205]"), ml::shape_error);
}

TEST_CASE("what is written is read back, aligned and without a copy") {
  const std::vector<float> w{1, -2, 3.5f, 0, 5, 6};
  const std::vector<double> d{0.1};
  const std::vector<std::int64_t> n{7, -8};
  const std::vector<std::uint8_t> u{1, 2, 3};
  const std::vector<TensorView> tensors{
      ml::tensor_view("u", {3}, std::span<const std::uint8_t>(u)),
      ml::tensor_view("layers.0.weight", {2, 3}, std::span<const float>(w)),
      ml::tensor_view("gr\xC3\xB6\xC3\x9F\"e\\\n", {}, std::span<const double>(d)),
      ml::tensor_view("n", {2, 1}, std::span<const std::int64_t>(n)),
      ml::tensor_view("none", {0, 4}, std::span<const float>()),
  };
  const TemporaryFolder folder;
  const auto path = folder / "w.safetensors";
  ml::write_safetensors(path, tensors, {{"license", "CC0"}, {"quote", "\"\x01\""}});
  const auto file = SafetensorsFile::open(path);
  CHECK(file.name() == path.string());
  CHECK(file.metadata().at("quote") == "\"\x01\"");
  CHECK(file.tensors().size() == 5);
  const auto weight = ml::direct<float>(file.tensor("layers.0.weight"));
  REQUIRE(weight.has_value());
  CHECK(std::vector<float>(weight->begin(), weight->end()) == w);
  CHECK(ml::direct<double>(file.tensor("gr\xC3\xB6\xC3\x9F\"e\\\n")).value()[0] == 0.1);
  CHECK(ml::direct<std::int64_t>(file.tensor("n")).value()[1] == -8);
  CHECK_FALSE(ml::direct<double>(file.tensor("layers.0.weight")).has_value());  // another type
  CHECK(file.tensor("none").shape == Shape{0, 4});

  // a file is copied by writing its views, and comes out the same, byte by byte
  CHECK(ml::safetensors_bytes(file.tensors(), file.metadata()) == ml::safetensors_bytes(tensors, file.metadata()));
  CHECK(SafetensorsFile::from_bytes(ml::safetensors_bytes({})).metadata().at("format") == "pt");
  std::uint64_t header = 0;
  std::memcpy(&header, ml::safetensors_bytes(tensors).data(), 8);
  CHECK(header % 8 == 0);
}

TEST_CASE("every element type is written and read back") {
  std::vector<std::byte> numbers(64);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<std::byte>(i * 37 + 1);
  std::vector<TensorView> tensors;
  for (std::size_t i = 0; i < ml::dtype_table.size(); ++i)  // 8 elements of b bits are b bytes
    tensors.push_back({.name = std::string(ml::dtype_table[i].name),
                       .dtype = static_cast<DType>(i),
                       .shape = {2, 4},
                       .bytes = std::span(numbers).first(static_cast<std::size_t>(ml::dtype_table[i].bits))});
  const auto bytes = ml::safetensors_bytes(tensors);
  const auto file = SafetensorsFile::from_bytes(bytes);
  CHECK(file.tensors().size() == 22);
  for (const TensorView& t : tensors) {
    CAPTURE(t.name);
    const TensorView& found = file.tensor(t.name);
    CHECK(found.dtype == t.dtype);
    CHECK(found.shape == t.shape);
    CHECK(std::equal(found.bytes.begin(), found.bytes.end(), t.bytes.begin(), t.bytes.end()));
  }
}

TEST_CASE("what could not be read is not written") {
  const std::vector<float> w{1, 2};
  const auto view = [&](std::string name) { return ml::tensor_view(std::move(name), {2}, std::span<const float>(w)); };
  CHECK_THROWS_WITH_AS(ml::safetensors_bytes(std::vector{view("a"), view("a")}),
                       doctest::Contains("[motionlang.io.403]"), ml::io_error);
  CHECK_THROWS_WITH_AS(ml::safetensors_bytes(std::vector{view("\xFF")}), doctest::Contains("not UTF-8"), ml::io_error);
  auto wrong = view("a");
  wrong.shape = {3};
  CHECK_THROWS_WITH_AS(ml::safetensors_bytes(std::vector{wrong}), doctest::Contains("[motionlang.io.405]"),
                       ml::io_error);
  CHECK_THROWS_AS(ml::tensor_view("a", {3}, std::span<const float>(w)), ml::shape_error);
  const TemporaryFolder folder;
  CHECK_THROWS_WITH_AS(ml::write_safetensors(folder / "no/such/folder", {}), doctest::Contains("[motionlang.io.401]"),
                       ml::io_error);
  CHECK_THROWS_WITH_AS(SafetensorsFile::open(folder / "none"), doctest::Contains("[motionlang.io.401]"), ml::io_error);
}

TEST_CASE("element types have the names of the format") {
  for (std::size_t i = 0; i < ml::dtype_table.size(); ++i) {
    CHECK(ml::parse_dtype(ml::dtype_table[i].name) == static_cast<DType>(i));
  }
  CHECK_FALSE(ml::parse_dtype("f32").has_value());
  static_assert(ml::dtype_of<float>() == DType::F32 && ml::dtype_of<double>() == DType::F64);
  static_assert(ml::dtype_of<std::int64_t>() == DType::I64 && ml::dtype_of<std::uint16_t>() == DType::U16);
  static_assert(ml::dtype_of<bool>() == DType::BOOL && ml::dtype_of<std::int8_t>() == DType::I8);
}
