// Memory that opening a file of weights may take: nothing for large claims, no copy of tensors that can be mapped, and
// never more than twice the file and 64 MiB, whatever the file says.
#include <doctest/doctest.h>

#include <malloc.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <new>

#include <motionlang/file/pickle.hpp>
#include <motionlang/file/torch_file.hpp>
#include <motionlang/weights/weight_file.hpp>

#include "../support/joblib_dump.hpp"
#include "../support/temporary_folder.hpp"

namespace {

std::size_t held = 0, most_held = 0;  // bytes of the heap; the tests run in one thread

void* take(std::size_t bytes) {
  void* memory = std::malloc(bytes == 0 ? 1 : bytes);
  if (memory == nullptr) throw std::bad_alloc();
  held += malloc_usable_size(memory);
  most_held = std::max(most_held, held);
  return memory;
}
void give(void* memory) {
  held -= malloc_usable_size(memory);
  std::free(memory);
}

}  // namespace

[[gnu::noinline]] void* operator new(std::size_t bytes) { return take(bytes); }
[[gnu::noinline]] void operator delete(void* memory) noexcept { give(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { give(memory); }

namespace {

namespace ml = motionlang;
using namespace std::string_view_literals;
constexpr std::size_t mebibyte = std::size_t{1} << 20;

struct Cost {
  std::size_t bytes = 0;
  double milliseconds = 0;
  int error = 0;  // id
};
Cost cost_of(const std::filesystem::path& path) {
  const std::size_t before = most_held = held;
  const std::clock_t start = std::clock();  // of the processor: another program beside does not count
  Cost cost;
  try {
    ml::open_weights(path);
  } catch (const ml::error& e) {
    cost.error = e.id();
  }
  cost.bytes = most_held - before;
  cost.milliseconds = 1000.0 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return cost;
}

std::string number(std::uint64_t n) { return std::string(reinterpret_cast<const char*>(&n), sizeof n); }
void write(const std::filesystem::path& path, const std::string& begin, std::size_t size) {
  std::ofstream(path, std::ios::binary) << begin;
  std::filesystem::resize_file(path, size);  // sparse: the rest takes no room on the disk
}

}  // namespace

TEST_CASE("a file of 2 GB that claims much is refused in 10 ms and 1 MB") {
  const TemporaryFolder folder;
  constexpr std::size_t size = std::size_t{2} << 30;
  const std::pair<std::string, std::string> attacks[] = {
      {"header as long as the file", number(size - 8) + "{\"a\":"},
      {"longest header that is allowed", number(100'000'000) + "{\"a\":{\"dtype\":\"F32\",\"shape\":["},
      {"tensor as long as the file", number(60) + R"({"a":{"dtype":"U8","shape":[2147483648],"data_offsets":[0,1]}})"},
      {"zip", "PK\x03\x04"},
      {"older form of PyTorch", "\x80\x02" + std::string(ml::detail::torch_legacy_number)},
      {"pickle of a long text", "\x80\x04\x8d" + number(size)},
      {"pickle of long bytes", "\x80\x04\x8e" + number(size - 8)},
      {"array", "\x93NUMPY\x02" + std::string(1, '\0') + std::string("\xff\xff\xff\x7f")},
      {"packed", "\x78\x9c\x04"},
      {"zeros", ""}};
  for (const auto& attack : attacks) {  // no structured binding: Clang 14 does not let CAPTURE have one
    const std::string &what = attack.first, &begin = attack.second;
    CAPTURE(what);
    write(folder / "attack", begin, size);
    const Cost first = cost_of(folder / "attack"), cost = cost_of(folder / "attack");
    CHECK(cost.error != 0);
    CHECK(cost.bytes < mebibyte);
    CHECK(std::min(first.milliseconds, cost.milliseconds) < 10);
  }
}

TEST_CASE("F32 in safetensors and in PyTorch's archives is not copied") {
  const TemporaryFolder folder;
  constexpr std::size_t count = 16 * mebibyte;
  std::string header =
      ml::concat_text(R"({"w":{"dtype":"F32","shape":[)", count, R"(],"data_offsets":[0,)", 4 * count, "]}}");
  header.resize((header.size() + 7) / 8 * 8, ' ');
  write(folder / "large.safetensors", number(header.size()) + header, 8 + header.size() + 4 * count);
  const Cost cost = cost_of(folder / "large.safetensors");
  CHECK(cost.error == 0);
  CHECK(cost.bytes < mebibyte / 16);
  CHECK(cost.milliseconds < 50);
  const auto file = ml::open_weights(folder / "large.safetensors");
  REQUIRE(ml::direct<float>(file.tensor("w")));
  CHECK(ml::direct<float>(file.tensor("w"))->size() == count);
}

TEST_CASE("hostile files cost at most twice their size and 64 MiB") {
  const TemporaryFolder folder;
  const auto repeated = [](std::string_view part, std::size_t size) {
    std::string out;
    while (out.size() + part.size() <= size) out += part;
    return out;
  };
  std::string tensors = "{";
  for (int i = 0; tensors.size() < 8 * mebibyte; ++i)
    tensors += ml::concat_text(i > 0 ? "," : "", "\"", i, R"(":{"dtype":"U8","shape":[0],"data_offsets":[0,0]})");
  tensors += "}";
  std::string metadata = R"({"__metadata__":{)";
  for (int i = 0; metadata.size() < 8 * mebibyte; ++i)
    metadata += ml::concat_text(i > 0 ? "," : "", "\"", i, "\":\"\"");
  metadata += "}}";
  const std::size_t size = 8 * mebibyte;
  const std::pair<std::string, std::string> attacks[] = {
      {"values", "\x80\x02" + repeated("N", size) + "."},
      {"marks", "\x80\x02" + repeated("(", size) + "."},
      {"memo", "\x80\x04N" + repeated("\x94", size) + "."},
      {"empty lists", "\x80\x02(" + repeated("]", size) + "t."},
      {"one value on the stack", "\x80\x02Nq\x01(" + repeated("h\x01", size) + "t."},
      {"list grown by one", "\x80\x02]q\x01" + repeated("Na", size) + "."},
      {"numbers of a list", "\x80\x02](" + repeated("K\x01", size) + "e."},
      {"escaped texts", "\x80\x02(" + repeated("V\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\n", size) + "t."},
      {"names", "\x80\x02(" + repeated("ca\nb\n)R", size) + "t."},
      {"tensors of safetensors", number(tensors.size()) + tensors},
      {"metadata of safetensors", number(metadata.size()) + metadata}};
  const auto attack_with = [&](const std::string& what, const std::string& bytes) {
    CAPTURE(what);
    ml::write_file(folder / "attack", bytes);
    const Cost cost = cost_of(folder / "attack");
    CHECK(cost.error != 0);
    CHECK(cost.bytes <= 2 * bytes.size() + 64 * mebibyte);
    MESSAGE(what, ": ", cost.bytes / mebibyte, " MiB, ", cost.milliseconds, " ms, error ", cost.error);
  };
  for (const auto& [what, bytes] : attacks) {
    attack_with(what, bytes);
    if (!bytes.starts_with('\x80')) continue;
    std::string longer = bytes;  // what is not read costs, too
    longer.resize(29 * mebibyte);
    for (const std::string& pickle : {bytes, longer}) attack_with(what + ", packed", as_zlib(pickle));
  }
}

TEST_CASE("a packed dump costs what it unpacks to") {
  const TemporaryFolder folder;
  constexpr std::uint32_t size = 24 * mebibyte;
  ml::write_file(folder / "dump.pkl", as_zlib(joblib_dump(size, 0)));
  const Cost cost = cost_of(folder / "dump.pkl");
  CHECK(cost.error == 0);
  CHECK(cost.bytes >= size);
  CHECK(cost.bytes < size + mebibyte);
}

TEST_CASE(
    "an older file of PyTorch costs no more, although two of its pickles and the names of storages are held at once") {
  const TemporaryFolder folder;
  constexpr std::size_t size = 24 * mebibyte, key = mebibyte, keys = 22;
  constexpr std::size_t allowed = 24 * mebibyte + size, node = sizeof(ml::detail::PickleNode) + 8;
  std::string bytes = "\x80\x02" + std::string(ml::detail::torch_legacy_number);
  bytes += "\x80\x02M\xe9\x03.\x80\x02}X\x0d\x00\x00\x00little_endian\x88s."sv;
  bytes +=
      "\x80\x02X\x07\x00\x00\x00storageq\x00"
      "0ctorch\nFloatStorage\nq\x01"
      "0"sv;
  for (std::size_t i = 0; i < keys; ++i) {
    std::string name = std::to_string(i);
    name.resize(key, 'k');
    bytes += "(h\x00h\x01X"sv;
    bytes.append("\x00\x00\x10\x00"sv).append(name).append("NK\x00tQ0"sv);
  }
  for (std::size_t i = 0; i < allowed / node * 95 / 100; ++i) bytes += "N0";
  bytes += "}.\x80\x02";
  while (bytes.size() < size) bytes += "N0";
  ml::write_file(folder / "attack", bytes);
  const Cost cost = cost_of(folder / "attack");
  CHECK(cost.error == 405);
  CHECK(cost.bytes > 64 * mebibyte);  // it does get to the second pickle
  CHECK(cost.bytes <= 2 * bytes.size() + 64 * mebibyte);
  MESSAGE("older form: ", cost.bytes / mebibyte, " MiB, ", cost.milliseconds, " ms");
}
