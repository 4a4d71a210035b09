// Options of training runs: YAML, JSON, opt.txt, references.
#include <motionlang/file/file_value.hpp>
#include <motionlang/file/options_file.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;

namespace {

std::string listed(std::string_view text) {
  std::string all;
  for (const ml::FileValue& v : ml::parse_options(text, "x")) all += v.path + "=" + to_string(v) + ";";
  return all;
}

}  // namespace

TEST_CASE("options: YAML as programs write it, and JSON") {
  const auto options = ml::parse_options(
      "# a run\n"
      "name: 'two: words'  # said\n"
      "model:\n"
      "  width: 4\n"
      "  rate: 1.0e-05\n"
      "  empty:\n"
      "  parts:\n"
      "  - a\n"
      "  - kind: b\n"
      "    size: 2\n"
      "flat: [1, 2.5, x]\n"
      "tagged: !!python/tuple\n"
      "- true\n",
      "opt.yaml");
  std::string all;
  for (const auto& v : options) all += v.path + "=" + to_string(v) + " ";
  CHECK(all ==
        "name=two: words model/width=4 model/rate=1e-05 model/parts/0=a model/parts/1/kind=b model/parts/1/size=2 "
        "flat/0=1 "
        "flat/1=2.5 flat/2=x tagged/0=true ");
  CHECK(std::get<double>(ml::find_value(options, "model/rate")->value) == 1e-5);
  CHECK_ERROR(ml::parse_options("a: 1\n  b: 2\n", "x"), "[motionlang.io.403] x:2: indentation");
  CHECK_ERROR(ml::parse_options("a: |\n  b\n", "x"), "[motionlang.io.404] x:1");
  CHECK_ERROR(ml::parse_options("a\n", "x"), "a key with a colon");
  CHECK_ERROR(ml::parse_options("a: [[1, 2], [3]]\n", "x"), "[motionlang.io.404] x:1: brackets in brackets");
  std::string items;
  for (int i = 0; i < 100; ++i) items += "- ";
  CHECK_ERROR(ml::parse_options(items + "1\n", "x"), "[motionlang.io.405] x:1: nested too deeply");
  const auto json = ml::parse_options(R"({"a": {"b": [1, "t"]}, "c": null})", "x");
  CHECK((json.size() == 2 && json[1].path == "a/b/1" && std::get<std::string>(json[1].value) == "t"));
}

TEST_CASE("YAML: quotes hold commas, hashes, brackets and quotes") {
  CHECK(listed("a: ['one, two', \"three\", 4, 'it''s']\n") == "a/0=one, two;a/1=three;a/2=4;a/3=it's;");
  CHECK(listed("a: ['x # y', 'z']  # a comment\n") == "a/0=x # y;a/1=z;");
  CHECK(listed("a: \"tab\\tquote\\\"\"\n") == "a=tab\tquote\";");
  CHECK(listed("'it''s': 'x'\nb: don't, can't\n") == "it's=x;b=don't, can't;");
  CHECK(listed("a: ['open, 1]\n") == "a/0='open, 1;");
  CHECK(listed("a: ''\nb: '5'\nc: -3\n") == "a=;b=5;c=-3;");
  CHECK(std::holds_alternative<std::string>(ml::parse_options("b: '5'\n", "x").front().value));
}

TEST_CASE("YAML: hashes behind quotes in quotes, and in texts of several lines") {
  CHECK(listed("a: 'it''s # b'  # c\n") == "a=it's # b;");
  CHECK(listed("a: \"x\\\" # y\" # c\n'k''s # l': 1\n") == "a=x\" # y;k's # l=1;");
  CHECK(listed("a: ['it''s, # b', 2]\n") == "a/0=it's, # b;a/1=2;");
  CHECK(listed("a: 'one\n  two # three: 3\n  four'  # c\nb: 1 # c\n") == "a=one two # three: 3 four;b=1;");
  CHECK(listed("a: one\n\n# b\n  # c\n  two # c\n") == "a=one two;");
}

TEST_CASE("YAML: mappings in one line") {
  CHECK(listed("a: {b: 1, 'c d': 'x, # y', e: , f: z}\ng: {}\n") == "a/b=1;a/c d=x, # y;a/f=z;");
  CHECK(listed("- {a: 1, b: 2}\n- [1, 2]\n- {}\n") == "0/a=1;0/b=2;1/0=1;1/1=2;");
  CHECK_ERROR(ml::parse_options("b: 1\na: {b: [1, 2]}\n", "x"), "[motionlang.io.404] x:2: brackets in brackets");
  CHECK_ERROR(ml::parse_options("a: {b}\n", "x"), "[motionlang.io.403] x:1: a key with a colon expected in the braces");
}

TEST_CASE("a duplicate name is refused with both lines") {
  CHECK_ERROR(ml::parse_options("a:\n  b: 1\nc: 2\na:\n  d: 1\n", "x"),
              "[motionlang.io.403] x:4: 'a' is duplicated, first in line 1");
  CHECK_ERROR(ml::parse_options("a:\n- b: 1\n  c: 2\n  b: 3\n", "x"), "x:4: 'a/0/b' is duplicated, first in line 2");
  CHECK_ERROR(ml::parse_options("a: {b: 1, b: 1}\n", "x"), "x:1: 'a/b' is duplicated, first in line 1");
  CHECK_ERROR(ml::parse_options("---- Options\nlr: 1\n\nlr: 2\n", "opt.txt"),
              "opt.txt:4: 'lr' is duplicated, first in line 2");
  CHECK_ERROR(ml::parse_options("{\"lr\": 1,\n\"lr\": 2}", "x"), "x:2:1: the name 'lr' is duplicated, first at 1:2");
  CHECK(listed("a:\n- b: 1\n- b: 2\n") == "a/0/b=1;a/1/b=2;");
}

TEST_CASE("whole numbers of more than 64 bits are their digits") {
  CHECK(listed("{\"a\": 18446744073709551615, \"b\": 9223372036854775807, \"c\": -9223372036854775808}") ==
        "a=18446744073709551615;b=9223372036854775807;c=-9223372036854775808;");
  CHECK(listed("a: 18446744073709551615\n") == "a=18446744073709551615;");
}

TEST_CASE("YAML: long texts that programs fold, a byte order mark, numbers that no number can hold") {
  CHECK(listed("a:\n  note: one two\n    three\n    four\n  b: 2\nc: 'it''s\n  long'\n") ==
        "a/note=one two three four;a/b=2;c=it's long;");
  CHECK(listed("- one\n  two\n- 3\n") == "0=one two;1=3;");
  CHECK_ERROR(ml::parse_options("a: 1\n  2\n", "x"), "[motionlang.io.403] x:2");
  CHECK_ERROR(ml::parse_options("a: [1,\n  2]\n", "x"), "[motionlang.io.403] x:2");
  CHECK(listed("\xEF\xBB\xBF"
               "activation: relu\n") == "activation=relu;");
  CHECK(listed("\xEF\xBB\xBF"
               "{\"a\": 1}") == "a=1;");
  CHECK(listed("a: 12e45678\nb: 99999999999999999999999x\n") == "a=12e45678;b=99999999999999999999999x;");
}

TEST_CASE("opt.txt: lines between banners, as text-to-motion, TM2T and MotionDiffuse write them") {
  const auto options = ml::parse_options(
      "------------ Options -------------\n"
      "batch_size: 128\r\n"
      "dataset_name: t2m\n"
      "feat_bias: 5\n"
      "gpu_id: [0]\n"
      "is_continue: False\n"
      "is_train: True\n"
      "lr: 0.0002\n"
      "name: \n"
      "time: 12:30\n"
      "-------------- End ----------------\n",
      "opt.txt");
  const auto text = [&](const char* key) { return to_string(*ml::find_value(options, key)); };
  CHECK(options.size() == 9);
  CHECK(std::get<std::int64_t>(ml::find_value(options, "batch_size")->value) == 128);
  CHECK(!std::get<bool>(ml::find_value(options, "is_continue")->value));
  CHECK(std::get<double>(ml::find_value(options, "lr")->value) == 0.0002);
  CHECK((text("dataset_name") == "t2m" && text("gpu_id") == "[0]" && text("name").empty() && text("time") == "12:30"));
  CHECK_ERROR(ml::parse_options("---- Options\nnothing\n", "opt.txt"), "[motionlang.io.403] opt.txt:2: 'key: value'");
  CHECK_ERROR(ml::parse_options("---- Options\n: 3\n", "opt.txt"), "opt.txt:2");
}

TEST_CASE("references of OmegaConf lead to other options") {
  const auto options = ml::parse_options(
      "latent: ${model.width}\nmodel:\n  width: 256\n  copy: ${latent}\nround: ${again}\nagain: ${round}\n"
      "none: ${not.there}\n",
      "config.yaml");
  CHECK(std::get<std::int64_t>(ml::find_option(options, "latent")->value) == 256);
  CHECK(std::get<std::int64_t>(ml::find_option(options, "model/copy")->value) == 256);
  CHECK(ml::find_option(options, "round") == nullptr);
  CHECK(ml::find_option(options, "none") == nullptr);
  CHECK(ml::find_option(options, "nothing") == nullptr);
}

TEST_CASE("options take no more memory than options need") {
  CHECK_ERROR(ml::parse_options("a: " + std::string(2 << 20, 'x'), "x"), "[motionlang.io.405] x: 2097155 bytes");
  std::string wide = std::string(100'000, 'k') + ":\n";  // every path is that long
  for (int i = 0; i < 1000; ++i) wide += ml::concat_text(" b", i, ": 1\n");
  CHECK_ERROR(ml::parse_options(wide, "x"), "more options than a file of options has");
  std::string nested = "{\"" + std::string(100'000, 'k') + "\": [0";
  for (int i = 0; i < 1000; ++i) nested += ",0";
  CHECK_ERROR(ml::parse_options(nested + "]}", "x"), "[motionlang.io.405]");
}
