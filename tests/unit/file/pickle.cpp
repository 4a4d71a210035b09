// The pickle reader: values of every protocol, and files that must be refused. The files are made by
// tests/tools/make_pickles.py.
#include <motionlang/file/file_path.hpp>
#include <motionlang/file/pickle_arrays.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tests_folder.hpp"

#include <filesystem>

namespace ml = motionlang;
using ml::PickleKind;

namespace {

ml::FilePath sample(const std::string& name) {
  return std::filesystem::path(tests_folder()) / "fuzz/corpus/pickle" / name;
}
ml::Pickle parse(std::string_view bytes, const ml::PickleOptions& options = {}) {
  return ml::Pickle(std::as_bytes(std::span(bytes.data(), bytes.size())), "x.pkl", options);
}
using namespace std::string_view_literals;

/// The opcodes of an array of NumPy with one axis.
template <class T>
std::string array(const char* type, const std::vector<T>& values) {
  const std::string_view raw(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  return ml::concat_text("cnumpy.core.numeric\n_frombuffer\n(C", static_cast<char>(raw.size()), raw,
                         "cnumpy\ndtype\n(S'", type, "'\ntR(I", values.size(), "\ntS'C'\ntR");
}
std::string places(const std::vector<std::int32_t>& values) { return array("<i4", values); }
const std::string four = array<double>("<f8", {1, 2, 4, 8});

/// A matrix of SciPy with 2 rows and 3 columns, and its arrays.
std::string sparse(const std::string& type, const std::vector<std::pair<std::string, std::string>>& arrays) {
  std::string text =
      ml::concat_text("cscipy.sparse._", type.substr(0, 3), "\n", type, "\n)\x81(dS'_shape'\n(I2\nI3\nts");
  for (const auto& [name, opcodes] : arrays) text += ml::concat_text("S'", name, "'\n", opcodes, "s");
  return text + "b.";
}

}  // namespace

TEST_CASE("values of all protocols") {
  for (int protocol = 0; protocol < 6; ++protocol) {
    CAPTURE(protocol);
    const auto file = ml::Pickle::open(sample(ml::concat_text("values_p", protocol, ".pkl")));
    const auto v = file.root();
    CHECK(v.is(PickleKind::dict));
    CHECK(v["none"].is(PickleKind::none));
    CHECK(v["true"].boolean());
    CHECK(!v["false"].boolean());
    CHECK(v["small"].integer() == 7);
    CHECK(v["negative"].integer() == -70000);
    CHECK(v["large"].integer() == std::int64_t{1} << 40);
    CHECK(v["real"].real() == -1.25);
    CHECK(v["small"].real() == 7);
    CHECK(v["text"].text() == "Gr\u00fc\u00dfe \u2603");
    CHECK(ml::detail::as_text(v["bytes"].bytes()) == "\x00\xff"sv);
    const auto tuple = v["tuple"];
    CHECK(tuple.is(PickleKind::tuple));
    CHECK((tuple.size() == 4 && tuple[1][1].integer() == 3));
    CHECK(v["list"][1][0].integer() == 2);
    CHECK(v["again"].at() == v["list"].at());
    CHECK((v["set"].size() == 1 && v["set"][0].integer() == 5));
    CHECK((v["complex"].is(PickleKind::object) && v["complex"].name().ends_with(".complex")));
    CHECK(v["complex"].arguments()[1].real() == 2);
    CHECK(v["default"]["a"].integer() == 1);
    CHECK(ml::to_array(v["scalar"]).value<double>() == 2.5);
    CHECK(ml::to_array(v["half"]).to<float>() == std::vector<float>{1, -2});
    CHECK(ml::to_array(v["texts"]).texts() == std::vector<std::string>{"male", "\u00fc"});
    CHECK(ml::to_array(v["flags"]).to<int>() == std::vector<int>{1, 0});
    CHECK(ml::to_array(v["empty"]).shape == std::vector<ml::Index>{0, 3});
  }
}

TEST_CASE("whole numbers beyond 64 bits come as their bytes or digits") {
  CHECK(parse("I99999999999999999999\n.").root().text() == "99999999999999999999");
  const auto file = ml::Pickle::open(sample("values_p2.pkl"));
  const auto bytes = file.root()["huge"].bytes();
  CHECK(bytes.size() == 13);
  CHECK(bytes[12] == std::byte{16});
}

TEST_CASE("Python 2: texts in quotes, numbers as lines, instances") {
  CHECK(parse("S'a\\x41\\n\\'\\101'\n.").root().text() == "aA\n'A");
  CHECK(parse("Va\\u00e9\\U0001f600\xe9\n.").root().text() == "a\u00e9\U0001F600\u00e9");
  CHECK(parse("L-12L\n.").root().integer() == -12);
  CHECK(parse("I01\n.").root().is(PickleKind::boolean));
  CHECK(parse("F2.5\n.").root().real() == 2.5);
  CHECK(parse("(dp0\nS'k'\nI5\ns.").root()["k"].integer() == 5);
  CHECK(parse("(lp0\nI1\naI2\na.").root().size() == 2);
  const auto instance = parse("(iargparse\nNamespace\n(dS'x'\nI3\nsb.");
  CHECK(instance.root().name() == "argparse.Namespace");
  CHECK(instance.root().state()["x"].integer() == 3);
  CHECK(parse("(cm\nC\nI1\no.").root().arguments()[0].integer() == 1);
  CHECK(parse("ccopy_reg\n_reconstructor\n(cm\nC\nc__builtin__\nobject\nNtR.").root().name() == "m.C");
}

TEST_CASE("dictionaries in disguise") {
  CHECK(parse("ccollections\nOrderedDict\n((l(lS'a'\naI1\naatR.").root()["a"].integer() == 1);
  CHECK(parse("ccollections\nOrderedDict\n((S'a'\nI1\nt(S'b'\nI3\ntt\x85R.").root()["b"].integer() == 3);
  const auto ordered = parse(
      "\x80\x02"
      "ccollections\nOrderedDict\n)RX\x01\0\0\0kK\x05s}b."sv);
  CHECK((ordered.root().size() == 1 && ordered.root().key(0).text() == "k" && ordered.root().value(0).integer() == 5));
  const auto subclass = parse(
      "\x80\x02"
      "cm\nC\n)\x81K\x01"
      "aK\x02"
      "a."sv);  // a list of a class that nobody knows
  CHECK((subclass.root().size() == 2 && subclass.root()[1].integer() == 2));
  CHECK(parse("\x80\x02}X\x01\0\0\0aK\x01sX\x01\0\0\0aK\x02s."sv).root()["a"].integer() == 2);
}

TEST_CASE("several pickles in a row") {
  const auto bytes = "K\x01.K\x02."sv;
  const auto first = parse(bytes);
  CHECK(first.end() == 3);
  CHECK(ml::Pickle(std::as_bytes(std::span(bytes.data(), bytes.size())), "x", {}, nullptr, first.end())
            .root()
            .integer() == 2);
}

TEST_CASE("persistent ids, where they are expected") {
  const auto file = ml::Pickle::open(sample("persistent.pkl"), {.persistent_ids = true});
  CHECK(file.root().is(PickleKind::persistent));
  CHECK(file.root().arguments()[1].name() == "torch.FloatStorage");
  CHECK_ERROR(ml::Pickle::open(sample("persistent.pkl")), "[motionlang.io.404]");
}

TEST_CASE("a list of allowed names") {
  constexpr std::string_view allowed[] = {"numpy.", "collections.OrderedDict"};
  CHECK(parse("cnumpy.core\nx\n.", {.allowed = allowed}).root().name() == "numpy.core.x");
  CHECK(parse("ccollections\nOrderedDict\n.", {.allowed = allowed}).root().is(PickleKind::name));
  CHECK_ERROR(parse("ccollections\nOrderedDic\n.", {.allowed = allowed}),
              "which is not allowed here at byte 0 (GLOBAL)");
}

TEST_CASE("what executes code is refused") {
  CHECK_ERROR(ml::Pickle::open(sample("os_system.pkl")),
              "posix.system: the file tries to execute code at byte 2 (GLOBAL)");
  CHECK_ERROR(ml::Pickle::open(sample("eval_p0.pkl")), "__builtin__.eval: the file tries to execute code");
  CHECK_ERROR(parse("\x80\x04\x8c\x0asubprocess\x8c\x05Popen\x93."),
              "[motionlang.io.404] x.pkl: pickle: names subprocess.Popen");
  CHECK_ERROR(parse("(ios.path\njoin\n."), "[motionlang.io.404]");
}

TEST_CASE("damaged files are refused with the place") {
  auto refuse = [](std::string_view bytes, const char* text) { CHECK_ERROR(parse(bytes), text); };
  refuse("", "[motionlang.io.402] x.pkl: pickle: ends inside opcode at byte 0");
  refuse("M\x01", "[motionlang.io.402] x.pkl: pickle: ends inside integer at byte 0 (BININT2)");
  refuse("NX\x09\0\0\0abc"sv,
         "[motionlang.io.402] x.pkl: pickle: text of 9 bytes where 3 are left at byte 1 (BINUNICODE)");
  refuse(".", "[motionlang.io.403] x.pkl: pickle: nothing on the stack at byte 0 (STOP)");
  refuse("K\x01(.", "nothing on the stack at byte 3 (STOP)");
  refuse("h\x05.", "[motionlang.io.403] x.pkl: pickle: memo 5 was never written at byte 0 (BINGET)");
  refuse("\x80\x06.", "[motionlang.io.404] x.pkl: pickle: protocol 6");
  refuse("\x82\x01.", "[motionlang.io.404]");
  refuse("\xf0.", "opcode 240 at byte 0");
  refuse("cm\nC\nK\x02R.", "a call with a whole number at byte 7 (REDUCE)");
  refuse("\x80\x02K\x01)R.", "[motionlang.io.403] x.pkl: pickle: a call of a whole number at byte 5 (REDUCE)");
  refuse("K\x01)\x81.", "a call of a whole number at byte 3 (NEWOBJ)");
  refuse("}K\x01\x85u.", "no mark");
  refuse("}(K\x01u.", "a key without a value");
  refuse("](K\x01K\x02u.", "entries for a list");
  refuse(
      "}K\x01"
      "a.",
      "elements for a dictionary");
  refuse("K\x01}b.", "a state for a whole number");
  refuse("I12x\n.", "[motionlang.io.403] x.pkl: pickle: not a whole number: '12x' at byte 0");
  refuse("L\n.", "not a whole number: ''");
  refuse("F1.5.2\n.", "not a real number");
  refuse("S'abc\n.", "a text without quotes");
  refuse("S'\\xg0'\n.", "a damaged escape");
  refuse("V\\u12\n.", "a damaged escape");
  refuse("X\x02\0\0\0\xff\xfe."sv, "not UTF-8");
  refuse("I5", "[motionlang.io.402] x.pkl: pickle: a line without end");
  refuse("T\xff\xff\xff\xff.", "a negative length");
  refuse("\x95\xff\0\0\0\0\0\0\0N."sv,
         "[motionlang.io.402] x.pkl: pickle: a frame of 255 bytes where 2 are left at byte 0 (FRAME)");
  refuse("c_codecs\nencode\n(X\x03\0\0\0\xe2\x98\x83X\x06\0\0\0latin1tR."sv, "bytes outside Latin-1");
  refuse("c_codecs\nencode\n(X\x01\0\0\0aX\x06\0\0\0rot_13tR."sv, "an encoding other than Latin-1");
  CHECK_ERROR(ml::Pickle::open(sample("huge_text.pkl")), "[motionlang.io.402]");
  CHECK_ERROR(ml::Pickle::open(sample("huge_bytes8.pkl")), "[motionlang.io.402]");
  CHECK_ERROR(parse("((((((((((.", {.max_values = 3}), "nothing on the stack");
  CHECK_ERROR(parse("NNNN.", {.max_values = 3}), "[motionlang.io.405] x.pkl: pickle: more values");
}

TEST_CASE("every beginning of a file is refused") {
  for (const char* name : {"values_p0.pkl", "values_p2.pkl", "values_p5.pkl", "body_python2.pkl"}) {
    const std::string whole = ml::read_file(sample(name));
    for (std::size_t n = 0; n < whole.size(); ++n) CHECK_THROWS_AS(parse(whole.substr(0, n)), ml::io_error);
  }
}

TEST_CASE("graphs that would explode are small here") {
  const auto laughs = ml::Pickle::open(sample("laughs.pkl"));
  CHECK(laughs.root()[9][3][0].size() == 10);
  const auto cyclic = ml::Pickle::open(sample("cyclic.pkl"));
  CHECK(cyclic.root()[0][0].at() == cyclic.root().at());
  CHECK(ml::Pickle::open(sample("deep.pkl")).root().size() == 1);
  CHECK_ERROR(ml::to_array(ml::Pickle::open(sample("deep_ch.pkl")).root()), "[motionlang.io.405]");
}

TEST_CASE("sparse matrices: as a list of entries, which may name a place twice, and compressed") {
  const std::vector<double> full{1, 0, 2, 12, 0, 0};
  const auto dense = [](const std::string& bytes) {
    const ml::NpyArray a = ml::to_array(parse(bytes).root());
    CHECK(a.shape == std::vector<ml::Index>{2, 3});
    return a.to<double>();
  };
  const std::string row = places({0, 0, 1, 1}), column = places({0, 2, 0, 0});
  CHECK(dense(sparse("coo_matrix", {{"row", row}, {"col", column}, {"data", four}})) == full);
  CHECK(dense(sparse("coo_array", {{"coords", "(" + row + column + "t"}, {"data", four}})) == full);
  CHECK(dense(sparse("csr_array", {{"indptr", places({0, 2, 4})}, {"indices", column}, {"data", four}})) == full);
  CHECK(dense(sparse("csc_matrix",
                     {{"indptr", places({0, 3, 3, 4})}, {"indices", places({0, 1, 1, 0})}, {"data", four}})) ==
        std::vector<double>{1, 0, 8, 6, 0, 0});

  const auto refused = [](const std::string& bytes, const char* text) {
    CHECK_ERROR(ml::to_array(parse(bytes).root()), text);
  };
  refused(sparse("coo_matrix", {{"row", row}, {"col", places({0, 3, 0, 0})}, {"data", four}}),
          "[motionlang.io.403] x.pkl: entry 0, 3 in a sparse matrix of 2 x 3");
  refused(sparse("coo_matrix", {{"row", places({0, -1, 1, 1})}, {"col", column}, {"data", four}}), "entry -1, 2");
  refused(sparse("coo_matrix", {{"row", row}, {"col", places({0})}, {"data", four}}), "arrays do not fit together");
  refused(sparse("coo_matrix", {{"row", row}, {"data", four}}), "[motionlang.io.406] x.pkl: no entry 'col'");
  refused(sparse("csr_matrix", {{"indptr", places({0, 2, 3})}, {"indices", column}, {"data", four}}),
          "do not fit together");
  refused(sparse("csr_matrix", {{"indptr", places({0, 2, 4})}, {"indices", places({0, 2, 0})}, {"data", four}}),
          "do not fit together");
  refused(sparse("lil_matrix", {}), "[motionlang.io.404] x.pkl: a sparse matrix of class scipy.sparse._lil.lil_matrix");
}

TEST_CASE("a value of another kind, an entry that is missing") {
  const auto file = parse("\x80\x02}X\x01\0\0\0aK\x01s."sv);
  CHECK_ERROR(file.root()["b"], "[motionlang.io.406] x.pkl: no entry 'b' in the dictionary at byte 2");
  CHECK_ERROR(file.root()["a"].text(),
              "[motionlang.io.407] x.pkl: a text expected, found a whole number at byte 9 (BININT1)");
  CHECK_ERROR(file.root().integer(), "found a dictionary");
  CHECK_ERROR(file.root()[0], "[motionlang.io.407]");
  CHECK_ERROR(file.root()["a"].state(), "[motionlang.io.407]");
  CHECK_ERROR(file.root().key(1), "[motionlang.io.407]");
  CHECK_ERROR(ml::to_array(file.root()), "an array expected, found a dictionary");
}
