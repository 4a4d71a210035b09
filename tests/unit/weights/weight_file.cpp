// Files of weights: what open_weights finds in every format, what it skips, and what it refuses. The golden cases
// "container read" and "container reject" have many more files. Samples are made by tests/tools/make_weights.py.
#include <ctime>

#include <motionlang/file/key_report.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/file/torch_file.hpp>
#include <motionlang/file/zip.hpp>
#include <motionlang/weights/weight_file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/joblib_dump.hpp"
#include "../../support/temporary_folder.hpp"
#include "../../support/tests_folder.hpp"

namespace ml = motionlang;
using ml::DType, ml::Shape;

namespace {

const std::filesystem::path tests = tests_folder();

std::filesystem::path sample(const std::string& name) { return tests / "fuzz/corpus/weights" / name; }
ml::WeightFile open(const std::string& name, const ml::WeightOptions& options = {}) {
  return ml::open_weights(sample(name), options);
}
std::vector<float> floats(const ml::WeightFile& file, const std::string& tensor) {
  return ml::values_of<float>(file.tensor(tensor));
}
template <class T>
T value(const ml::WeightFile& file, const std::string& path) {
  const ml::FileValue* v = file.value(path);
  REQUIRE_MESSAGE(v != nullptr, path);
  return std::get<T>(v->value);
}
using Skipped = std::vector<ml::SkippedValue>;
const std::vector<float> six{0, 1, 2, 3, 4, 5}, transposed{0, 3, 1, 4, 2, 5};

}  // namespace

TEST_CASE("PyTorch: both forms, views, halves, whole numbers") {
  for (const char* name : {"spec_zip.pt", "spec_legacy.pt"}) {
    CAPTURE(name);
    const auto file = open(name);
    CHECK(file.names() == std::vector<std::string>{"h", "n", "w", "wt"});
    CHECK(floats(file, "w") == std::vector<float>{0, 0.25F, 0.5F, 0.75F, 1, 1.25F});
    CHECK(file.tensor("wt").shape == Shape{3, 2});
    CHECK(floats(file, "wt") == std::vector<float>{0, 0.75F, 0.25F, 1, 0.5F, 1.25F});
    CHECK(file.tensor("h").dtype == DType::F16);
    CHECK(floats(file, "h") == std::vector<float>{1, -2.5F});
    CHECK(file.tensor("n").shape == Shape{});
    CHECK(ml::values_of<std::int64_t>(file.tensor("n")) == std::vector<std::int64_t>{7});
  }
  CHECK(open("spec_zip.pt").format() == "torch zip");
  CHECK(open("spec_legacy.pt").format() == "torch legacy");
}

TEST_CASE("PyTorch's older form in newer protocols of pickle") {
  std::string bytes = ml::read_file(sample("spec_legacy.pt"));
  const auto opened = [&] { return ml::WeightFile::from_bytes(std::as_bytes(std::span(bytes)), "x.pt"); };
  bytes[1] = 3;
  CHECK(floats(opened(), "w") == floats(open("spec_legacy.pt"), "w"));
  bytes[1] = 4;
  bytes.insert(2, std::string_view("\x95\x0d\0\0\0\0\0\0\0", 9));  // the number in a frame
  CHECK(opened().format() == "torch legacy");
  CHECK(floats(opened(), "w") == floats(open("spec_legacy.pt"), "w"));
  bytes[3] = 0x0c;
  CHECK_ERROR(opened(), "[motionlang.io.");
}

TEST_CASE("tensors of more axes than ours have") {
  const auto torch = open("many_axes.pt");
  CHECK(torch.names() == std::vector<std::string>{"w", "wt"});  // 65 axes are more than PyTorch has
  CHECK(torch.skipped() == Skipped{{"too_many", "torch._utils._rebuild_tensor_v2"}});
  CHECK(torch.tensor("w").shape == ml::FileShape{1, 2, 1, 1, 3, 1, 1, 1, 1});
  CHECK(floats(torch, "w") == six);
  CHECK(torch.tensor("wt").shape.rank() == 32);
  CHECK(floats(torch, "wt") == transposed);
  std::vector<ml::Index> sizes(40, 1);
  sizes[38] = 2, sizes[39] = 3;
  const auto npy = ml::npy_bytes(ml::NpyArray::of(std::span<const float>(six), sizes));
  const auto array = ml::WeightFile::from_bytes(npy, "x.npy");
  CHECK(array.tensor("array").shape == ml::FileShape(sizes));
  CHECK(floats(array, "array") == six);
  const auto again = ml::SafetensorsFile::from_bytes(ml::safetensors_bytes(array.tensors()));
  CHECK(again.tensor("array").shape == ml::FileShape(sizes));
  const auto in_memory = [](const ml::FileShape& s) { return ml::Shape(s); };
  CHECK_ERROR(in_memory(array.tensor("array").shape), "[motionlang.shape.206]");
}

TEST_CASE("PyTorch: tensors that lie in order in the file are views of it") {
  const auto mapped = ml::MappedFile::open(sample("spec_zip.pt"));
  const auto bytes = mapped->bytes();
  const auto file = ml::WeightFile::from_bytes(bytes, "x.pt", mapped);
  const auto inside = [&](const char* name) {
    const std::byte* at = file.tensor(name).bytes.data();
    return at >= bytes.data() && at < bytes.data() + bytes.size();
  };
  CHECK(inside("w"));
  CHECK(ml::direct<float>(file.tensor("w")).has_value());
  CHECK(!inside("wt"));
}

TEST_CASE("PyTorch: checksums of storages are compared where that is asked for; modules with source code") {
  std::string bytes = ml::read_file(sample("spec_zip.pt"));
  const auto open_bytes = [&](bool checksums) {
    return ml::WeightFile::from_bytes(std::as_bytes(std::span(bytes)), "x.pt", {}, {.checksums = checksums});
  };
  CHECK(floats(open_bytes(true), "h") == std::vector<float>{1, -2.5F});
  const auto* const at = reinterpret_cast<const char*>(open_bytes(false).tensor("h").bytes.data());
  bytes[static_cast<std::size_t>(at - bytes.data())] ^= 1;
  CHECK(floats(open_bytes(false), "h").at(1) == -2.5F);
  CHECK_ERROR(open_bytes(true), "checksum");

  std::string module = ml::read_file(sample("spec_legacy.pt"));
  const std::string_view storage("X\x07\0\0\0storage", 12);
  REQUIRE(module.find(storage) != std::string::npos);
  module.replace(module.find(storage), storage.size(), std::string_view("X\x06\0\0\0module", 11));
  CHECK_ERROR(ml::WeightFile::from_bytes(std::as_bytes(std::span(module)), "x.pt"), "save its state_dict()");
}

TEST_CASE("PyTorch: big-endian, packed, older and newer ways to rebuild tensors") {
  CHECK(floats(open("big_endian.pt"), "w") == six);
  CHECK(floats(open("big_endian.pt"), "t") == transposed);
  CHECK(floats(open("deflated.pt"), "w") == six);
  const auto file = open("v3.pt");
  CHECK(floats(file, "w") == std::vector<float>{7, 8});
  CHECK(floats(file, "old") == std::vector<float>{1, 3});
  CHECK(floats(file, "parameter") == six);
  CHECK(floats(file, "state") == six);
  CHECK((file.tensor("complex").dtype == DType::C64 && file.tensor("complex").shape == Shape{3}));
  CHECK(file.find("quantized") == nullptr);
  CHECK(file.skipped() == Skipped{{"quantized", "torch._utils._rebuild_tensor_v2"}});
  CHECK_ERROR(open("v3.pt", {.path = {}, .strict = true}), "a storage of class torch.QInt8Storage");
  CHECK(floats(open("views_legacy.pt"), "part") == std::vector<float>{2, 3, 4});
  CHECK(floats(open("nested_storage.pkl"), "w") == six);
}

TEST_CASE("checkpoints: the tensors are found, other entries are listed, classes that nobody knows are skipped") {
  const auto file = open("checkpoint.ckpt");
  CHECK(file.names() == std::vector<std::string>{"a", "b"});
  CHECK(value<std::int64_t>(file, "epoch") == 3);
  CHECK(value<double>(file, "settings/rate") == 0.5);
  CHECK(value<double>(file, "optimizer_states/0/lr") == 0.1);
  CHECK(file.skipped() == Skipped{{"config", "nobody.Config"}, {"", "an entry whose key is a name"}});
  CHECK(to_string(file.skipped().front()) == "nobody.Config at 'config'");
  CHECK(open("checkpoint.ckpt", {.path = "optimizer_states/0"}).names() == std::vector<std::string>{"state.0.exp_avg"});
  CHECK(open("checkpoint.ckpt", {.path = ""}).names() ==
        std::vector<std::string>{"optimizer_states.0.state.0.exp_avg", "state_dict.a", "state_dict.b"});
  CHECK_ERROR(open("checkpoint.ckpt", {.path = "model"}), "[motionlang.io.406]");
  CHECK(open("checkpoint.ckpt", {.path = {}, .strict = true}).tensors().size() == 2);
  CHECK_ERROR(open("checkpoint.ckpt", {.path = "", .strict = true}), "an object of class nobody.Config at 'config'");
}

TEST_CASE("configurations in objects of classes that nobody knows are read, their tensors are not") {
  for (int protocol = 1; protocol <= 5; ++protocol) {
    CAPTURE(protocol);
    const std::string name = ml::concat_text("objects_p", protocol, ".ckpt");
    const auto file = open(name);
    CHECK(file.names() == std::vector<std::string>{"a"});
    const auto has = [&](const std::string& object, const auto&... fields) {
      CAPTURE(object);
      const auto check = [&](const std::string& field) {
        const std::string path = "hyper_parameters/" + object + "/" + field;
        if (field == "latent_dim") CHECK(value<std::int64_t>(file, path) == 256);
        if (field == "name") CHECK(value<std::string>(file, path) == "temos");
        if (field == "vae") CHECK(value<bool>(file, path));
        if (field == "rate") CHECK(value<double>(file, path) == 1e-4);
      };
      (check(fields), ...);
    };
    has("plain", "latent_dim", "name", "vae", "rate");
    has("nested/inner", "latent_dim", "name", "vae", "rate");
    has("loop", "latent_dim", "name", "vae", "rate");
    has("namespace", "latent_dim", "name", "vae", "rate");
    has("simple", "latent_dim", "name", "vae", "rate");
    has("tree", "latent_dim", "name");
    has("settings", "latent_dim", "name");
    has("repeated", "latent_dim", "name");
    has("frozen", "latent_dim", "name");
    has("ordered", "latent_dim");
    has("user/data", "latent_dim");
    has("partial", "latent_dim");
    if (protocol >= 2) has("slots", "latent_dim"), has("slots_too", "latent_dim", "name");
    if (protocol >= 4) has("keywords", "latent_dim");
    CHECK(value<std::int64_t>(file, "hyper_parameters/nested/layers/0") == 1);
    CHECK(value<std::int64_t>(file, "hyper_parameters/nested/layers/1/heads") == 4);
    CHECK(value<std::int64_t>(file, "hyper_parameters/tree/inner/heads") == 4);
    CHECK(value<std::string>(file, "hyper_parameters/mode") == "training");
    CHECK(value<std::string>(file, "hyper_parameters/nested/mode") == "training");
    for (const ml::FileValue& v : file.values()) {  // once each: loops end, and shared values are listed once
      CHECK_MESSAGE(v.path.find("again") == std::string::npos, v.path);
      CHECK_MESSAGE(v.path.find("_parent") == std::string::npos, v.path);
      CHECK_MESSAGE(file.value(v.path) == &v, v.path);
    }
    // the state dictionary is known throughout, the root is not
    CHECK(open(name, {.path = {}, .strict = true}).names() == file.names());
    CHECK_ERROR(open(name, {.path = "", .strict = true}),
                "an object of class nobody.Config at 'hyper_parameters/plain'");
  }
}

TEST_CASE("graphs of objects that nobody knows end, and leave the rest of the file to be read") {
  // Object i holds all later ones twice: 2^30 ways through them. Then a dictionary that 3,000 objects share.
  std::string graph = "\x80\x02}(U\1g(l";
  for (int i = 0; i < 30; ++i) {
    graph += ml::concat_text("cnobody\nNode\n)\x81p", i, "\n}(");
    for (int k = std::max(0, i - 10); k < i; ++k)
      graph += ml::concat_text("S'a", k, "'\ng", k, "\nS'b", k, "'\ng", k, "\n");
    graph +=
        "ub"
        "a";
  }
  graph += "U\1h}p99\n(";
  for (int i = 0; i < 2000; ++i) graph += ml::concat_text("S'", i, "'\n]");
  graph += "uU\1s(l";
  for (int i = 0; i < 3000; ++i) graph += "cnobody\nNode\n)\x81g99\nba";
  graph += "U\1x](K\1K\2eU\1yK\3u.";
  const std::clock_t start = std::clock();
  const auto file = ml::WeightFile::from_bytes(std::as_bytes(std::span(graph)), "x.pkl");
  CHECK((std::clock() - start) / CLOCKS_PER_SEC < 5);
  CHECK(file.names() == std::vector<std::string>{"x"});
  CHECK(value<std::int64_t>(file, "y") == 3);
}

TEST_CASE("each of several values of one class is skipped by its own keys, the first thousand are listed") {
  std::string pickle = "\x80\x02(dS'layers'\n(l";
  for (int i = 0; i < 1001; ++i)
    pickle +=
        "cnobody\nLayer\n)\x81"
        "a";
  pickle += "sS'x'\n(lI1\naI2\nas.";
  const auto file = ml::WeightFile::from_bytes(std::as_bytes(std::span<const char>(pickle)), "x.pkl");
  CHECK(file.names() == std::vector<std::string>{"x"});
  REQUIRE(file.skipped().size() == 1000);
  CHECK(to_string(file.skipped().front()) == "nobody.Layer at 'layers/0'");
  CHECK(to_string(file.skipped().back()) == "nobody.Layer at 'layers/999'");
}

TEST_CASE("whole numbers and bytes are keys; entries with others are skipped, and what is nested too deeply") {
  using namespace std::string_view_literals;
  const auto opened = [](std::string_view pickle) {
    return ml::WeightFile::from_bytes(std::as_bytes(std::span<const char>(pickle)), "x.pkl");
  };
  const auto file =
      opened("\x80\x03}(X\1\0\0\0a}(K\0}C\1b](K\1K\2esK\1\x85](K\3eG\0\0\0\0\0\0\0\0](K\4e\x88](K\5euu."sv);
  CHECK(file.names() == std::vector<std::string>{"a/0/b"});
  CHECK(file.skipped() == Skipped{{"a", "an entry whose key is a tuple"},
                                  {"a", "an entry whose key is a real number"},
                                  {"a", "an entry whose key is a truth value"}});
  const auto nested = [&](int dictionaries) {
    std::string pickle = "\x80\x02";
    for (int i = 0; i < dictionaries; ++i) pickle += "}U\1k";
    pickle += "](K\1K\2e" + std::string(static_cast<std::size_t>(dictionaries), 's');
    return opened("\x80\x02(S'x'\n](K\1eS'y'\n" + pickle.substr(2) + "d.");
  };
  CHECK(nested(63).names().size() == 2);
  CHECK(nested(63).skipped().empty());
  CHECK(nested(64).names() == std::vector<std::string>{"x"});
  REQUIRE(nested(64).skipped().size() == 1);
  CHECK(nested(64).skipped().front().type == "a value that is nested too deeply");
}

TEST_CASE("a sparse matrix of another kind is skipped") {
  const std::string_view bytes = "\x80\x02(dS'm'\ncscipy.sparse._lil\nlil_matrix\n)\x81sS'x'\n(lI1\naI2\nas.";
  const auto file = ml::WeightFile::from_bytes(std::as_bytes(std::span(bytes)), "x.pkl");
  CHECK(file.names() == std::vector<std::string>{"x"});
  CHECK(file.skipped() == Skipped{{"m", "scipy.sparse._lil.lil_matrix"}});
}

TEST_CASE("Lightning with omegaconf, pathlib, functools, a NumPy scalar and a class as a key") {
  const auto file = open("spec_lightning.ckpt");
  CHECK(floats(file, "weight") == std::vector<float>{0.5F, -0.25F});
  CHECK(floats(file, "bias") == std::vector<float>{2});
  CHECK(value<std::int64_t>(file, "epoch") == 9);
  CHECK(value<std::int64_t>(file, "hyper_parameters/cfg/latent_dim") == 256);
  CHECK(value<std::string>(file, "hyper_parameters/cfg/name") == "temos");
}

TEST_CASE("TorchScript: paths of attributes are the names") {
  const auto file = open("script.pt");
  CHECK(file.format() == "TorchScript");
  CHECK(file.names() == std::vector<std::string>{"layers.0.weight", "layers.1.weight", "logit_scale"});
  CHECK(floats(file, "layers.1.weight") == transposed);
  CHECK(value<std::int64_t>(file, "width") == 3);
  CHECK(file.value("training") == nullptr);
}

namespace {

std::string as_gzip(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  const std::uint32_t end[] = {ml::detail::crc32(bytes), static_cast<std::uint32_t>(text.size())};
  return std::string("\x1F\x8B\x08\0\0\0\0\0\0\xFF", 10) + ml::detail::deflate(bytes) +
         std::string(reinterpret_cast<const char*>(end), sizeof end);
}

}  // namespace

TEST_CASE("joblib dumps, packed as a whole, as joblib 1.2 writes them") {
  for (const char* name : {"joblib_zlib3.pkl", "joblib_gzip3.pkl"}) {
    CAPTURE(name);
    const auto file = open(name);
    CHECK(file.format() == "joblib");
    CHECK(file.names() == std::vector<std::string>{"0/poses", "0/trans"});
    CHECK(floats(file, "0/poses") ==
          std::vector<float>{0, 0.25F, 0.5F, 0.75F, 1, 1.25F, 1.5F, 1.75F, 2, 2.25F, 2.5F, 2.75F});
    CHECK(ml::values_of<double>(file.tensor("0/trans")) == std::vector<double>{0, 1, 2, 3, 4, 5});
    CHECK(value<std::string>(file, "0/g") == "male");
  }
  CHECK_ERROR(open("joblib_bz2.pkl"), "packed with bzip2, which is not read: unpack it first");
  CHECK_ERROR(open("joblib_xz.pkl"), "packed with xz");
  CHECK_ERROR(open("joblib_lzma.pkl"), "packed with lzma");
}

TEST_CASE("packed dumps give at most twice the size of the file and 30 MiB") {
  const auto opened = [](const std::string& packed) {
    return ml::WeightFile::from_bytes(std::as_bytes(std::span(packed)), "x.pkl");
  };
  const auto limit = [](const std::string& packed) { return 2 * packed.size() + (30 << 20); };
  constexpr std::uint32_t size = 24 << 20;
  const std::string dump = joblib_dump(size, 7);
  for (const std::string& packed : {as_zlib(dump), as_gzip(dump)}) {
    const auto file = opened(packed);
    const auto bytes = file.tensor("array").bytes;
    CHECK(bytes.size() == size);
    CHECK(std::count(bytes.begin(), bytes.end(), std::byte{7}) == size);
  }
  const std::string small = as_zlib(joblib_dump(1000, 7));
  const auto unpacked = ml::detail::from_zlib(std::as_bytes(std::span(small)), 2000, "x.pkl");
  CHECK(unpacked.capacity() == unpacked.size());

  const std::string too_much = as_zlib(joblib_dump(32 << 20, 7));
  const std::string gives = ml::concat_text("deflated data gives more than ", limit(too_much), " bytes");
  CHECK_ERROR(opened(too_much), gives.c_str());
  std::string declared = as_gzip(joblib_dump(1000, 7));
  const auto said = static_cast<std::uint32_t>(limit(declared) + 1);
  std::memcpy(declared.data() + declared.size() - sizeof said, &said, sizeof said);
  const std::string declares = ml::concat_text("declares ", said, " bytes, may give ", said - 1);
  CHECK_ERROR(opened(declared), declares.c_str());
}

TEST_CASE("joblib dumps, packed or not; pickles of SMPL") {
  for (const char* name : {"spec_joblib.pkl", "joblib_packed.pkl", "joblib_gzip.pkl"}) {
    CAPTURE(name);
    const auto file = open(name);
    CHECK(file.format() == "joblib");
    CHECK(floats(file, "0/poses") == std::vector<float>{0, 1, 2, 3});
    CHECK(file.tensor("0/poses").shape == Shape{2, 2});
    CHECK(value<std::int64_t>(file, "0/fps") == 30);
    CHECK(value<std::string>(file, "0/g") == "male");
  }
  const auto body = open("spec_smpl.pkl");
  CHECK(floats(body, "J_regressor") == std::vector<float>{0.5F, 0.5F, 0, 0, 0, 1});
  CHECK(ml::values_of<double>(body.tensor("shapedirs"))[7] == 1.25);
  CHECK(floats(body, "posedirs")[1] == 0.5625F);
  CHECK(value<std::string>(body, "bs_type") == "lrotmin");
}

TEST_CASE("what asks for more than the file justifies is refused") {
  CHECK_ERROR(open("stride_bomb.pt"), "[motionlang.io.405]");
  CHECK_ERROR(open("many_expanded.pt"), "bytes more than a file of its size justifies");
  CHECK_ERROR(open("wrapping_sizes.pt"), "has more elements than its storage allows");
  CHECK_ERROR(open("count_legacy.pt"), "[motionlang.io.405]");
  CHECK_ERROR(ml::WeightFile::from_bytes({}, "empty"), "[motionlang.io.402] empty: 0 bytes are not a file of weights");
  std::string sizes =
      "\x80\x02"
      "ctorch\nSize\nq";  // Size((Size((...),)),)
  sizes += '\0';
  const int deep = 50'000;
  for (int i = 1; i < deep; ++i) sizes.append("h\0", 2);
  sizes += 'N';
  for (int i = 0; i < deep; ++i) sizes += "\x85R";
  sizes += '.';
  CHECK_ERROR(ml::WeightFile::from_bytes(std::as_bytes(std::span(sizes)), "deep.pkl"), "[motionlang.io.406]");
  const auto npy = ml::npy_bytes(ml::NpyArray::scalar(1.0F));
  CHECK(ml::WeightFile::from_bytes(npy, "a.npy").tensor("array").shape == Shape{});
  CHECK_ERROR(ml::WeightFile::from_bytes(npy, "a.npy", {}, {.path = "a"}), "[motionlang.io.406] a.npy: no entry 'a'");
  const std::string tar = std::string(257, '\0') + "ustar  \0";
  CHECK_ERROR(ml::WeightFile::from_bytes(std::as_bytes(std::span(tar)), "old.tar"), "a tar archive");
  CHECK_ERROR(ml::open_weights(tests / "nothing"), "[motionlang.io.401]");
  CHECK_ERROR(ml::open_weights(tests / "unit"), "no weights in this folder");
}

TEST_CASE("objects that share a large state, and numbers of NumPy that cannot be read, end in time") {
  const auto refused = [](const std::string& pickle, const ml::WeightOptions& options) {
    const std::clock_t start = std::clock();
    const auto bytes = std::as_bytes(std::span<const char>(pickle));
    CHECK_ERROR(ml::WeightFile::from_bytes(bytes, "x.pkl", {}, options),
                "[motionlang.io.405] x.pkl: more values to look at");
    CHECK((std::clock() - start) / CLOCKS_PER_SEC < 5);
  };
  std::string state("\x80\x02(comegaconf.nodes\nAnyNode\nq\0}q\1(", 34);
  for (int i = 0; i < 20'000; ++i) state += "K\1K\2";
  state += 'u';
  for (int i = 0; i < 50'000; ++i) state += std::string("h\0)Rh\1b", 7);
  refused(state + "t.", {});

  std::string scalars("\x80\x02}(U\1a}U\1b(cnumpy.core.multiarray\nscalar\nq\0", 44);
  for (int i = 0; i < 100'000; ++i) scalars += std::string("h\0)R", 4);
  refused(scalars + "tu.", {.path = "a"});
}

TEST_CASE("folders of training runs") {
  const auto actor = ml::open_weights(tests / "golden/cases/containers/actor_run");
  CHECK(actor.format() == "ACTOR run folder");
  CHECK(actor.find("encoder.muQuery") != nullptr);
  const TemporaryFolder folder;
  std::filesystem::copy(sample("spec_zip.pt"), folder / "one.pt");
  std::filesystem::copy(sample("checkpoint.ckpt"), folder / "two.pt");
  const auto both = ml::open_weights(folder.path);
  CHECK(both.format() == "folder");
  CHECK(floats(both, "two.a") == six);
  CHECK(both.find("one.w") != nullptr);
  CHECK(std::get<std::int64_t>(both.value("two/epoch")->value) == 3);
}

TEST_CASE("names that do not match are listed with the most similar of the other side") {
  CHECK(ml::edit_distance("kitten", "sitting", 9) == 3);
  CHECK(ml::edit_distance("kitten", "sitting", 2) == 2);
  CHECK(ml::edit_distance("", "abc", 9) == 3);
  CHECK(ml::edit_distance("rigth", "right", 9) == 1);
  CHECK(ml::edit_distance("ab", "ba", 9) == 1);
  CHECK(ml::edit_distance("foreward", "forward", 9) == 1);
  CHECK(ml::nearest_name("encoder.wieght", {"decoder.bias", "encoder.weight", "x"}) == "encoder.weight");
  CHECK(ml::nearest_name("abc", {"xyz"}) == "");
  const ml::KeyReport report{{"encoder.weight", "norm.bias"}, {"encoder.wieght"}};
  CHECK(to_string(report) ==
        "\n  missing    encoder.weight  (the file has encoder.wieght)"
        "\n  missing    norm.bias"
        "\n  unexpected encoder.wieght  (the model has encoder.weight)");
  CHECK(to_string(ml::KeyReport{std::vector<std::string>(25, "a"), {}}).ends_with("missing    5 more"));
}

namespace {

/// spec_zip.pt with `more` behind its data.pkl, and with a member of that name and content unless the name is empty.
std::vector<std::byte> changed_archive(std::string_view more, const std::string& name = "",
                                       std::string_view content = "") {
  const auto zip = ml::ZipArchive::open(sample("spec_zip.pt"));
  ml::ZipWriter out;
  for (const ml::ZipEntry& e : zip.entries()) {
    std::vector<std::byte> bytes = zip.read(e);
    if (e.name.ends_with("/data.pkl")) ml::detail::append_text(bytes, more);
    out.add(e.name, bytes);
  }
  if (!name.empty()) out.add(name, std::as_bytes(std::span<const char>(content)));
  return out.finish();
}

}  // namespace

TEST_CASE("PyTorch: what follows the pickle is reported, two roots are refused") {
  const auto bytes = changed_archive("more");
  const auto file = ml::WeightFile::from_bytes(bytes, "x.pt");
  CHECK(floats(file, "h") == std::vector<float>{1, -2.5F});
  CHECK(file.skipped() == Skipped{{"", "4 bytes behind the end of data.pkl"}});
  CHECK(ml::WeightFile::from_bytes(changed_archive(""), "x.pt").skipped().empty());
  CHECK_ERROR(ml::WeightFile::from_bytes(changed_archive("", "other/data.pkl", "\x80\x02}."), "x.pt"),
              "'other/data.pkl' at byte");
}

TEST_CASE("PyTorch: tensors that are negated on reading, whole modules") {
  const auto archive = [](std::string_view metadata) {
    using namespace std::string_view_literals;
    const std::string pickle = ml::concat_text(
        "\x80\x02}U\x01wctorch._utils\n_rebuild_tensor_v2\n((U\x07storagectorch\nFloatStorage\nU\x01"
        "0U\x03"
        "cpuK\x06tQK\x00K\x02K\x03\x86K\x03K\x01\x86\x89}"sv,
        metadata, "tRs."sv);
    ml::ZipWriter zip;
    zip.add("a/data.pkl", std::as_bytes(std::span<const char>(pickle)));
    zip.add("a/data/0", std::as_bytes(std::span(six)));
    return zip.finish();
  };
  CHECK(floats(ml::WeightFile::from_bytes(archive("}"), "x.pt"), "w") == six);
  CHECK_ERROR(ml::WeightFile::from_bytes(archive("}U\x03neg\x88s"), "x.pt"),
              "skipped: torch._utils._rebuild_tensor_v2 at 'w' (");
  CHECK_ERROR(ml::WeightFile::from_bytes(archive("}U\x03neg\x88s"), "x.pt", {}, {.path = {}, .strict = true}),
              "a tensor that is negated");

  const std::string_view module =
      "\x80\x02"
      "ctorch.nn.modules.linear\nLinear\n)\x81}b.";
  CHECK_ERROR(ml::WeightFile::from_bytes(std::as_bytes(std::span(module)), "x.pkl"),
              "skipped: torch.nn.modules.linear.Linear (of a whole module or model, save its state_dict())");
  const std::string legacy = "\x80\x02" + std::string(ml::detail::torch_legacy_number);
  const std::string with_source =
      legacy + "\x80\x02M\xe9\x03.\x80\x02}U\x0dlittle_endian\x88s.\x80\x02(U\x06moduleK\x01tQ)\x81.";
  CHECK_ERROR(ml::WeightFile::from_bytes(std::as_bytes(std::span(with_source)), "x.pt"),
              "a whole module with its source code");
}
