// Golden functions: files of weights in every format, to be read bit for bit or to be refused.
#include <algorithm>
#include <array>

#include <motionlang/file/options_file.hpp>
#include <motionlang/weights/weight_file.hpp>

#include "golden.hpp"

namespace {

using golden::Case, golden::Registration;
namespace ml = motionlang;

void expect(bool holds, const std::string& what) {
  if (!holds) throw std::runtime_error(what);
}

/// The name of an element type in NumPy and PyTorch.
std::string type_name(ml::DType t) {
  const std::string name = to_string(t);
  const std::map<char, std::string> kinds{{'F', "float"}, {'I', "int"}, {'U', "uint"}};
  return t == ml::DType::BOOL ? "bool" : t == ml::DType::BF16 ? "bfloat16" : kinds.at(name[0]) + name.substr(1);
}

/// A value of the case, and the one that was read: equal, and of a kind that holds it.
void expect_value(const nlohmann::json& want, const ml::FileValue* got, const std::string& path) {
  if (want.is_null()) return expect(got == nullptr, path);
  expect(got != nullptr, "no value at " + path);
  if (want.is_boolean())
    expect(std::get<bool>(got->value) == want.get<bool>(), path);
  else if (want.is_number_integer())
    expect(std::get<std::int64_t>(got->value) == want.get<std::int64_t>(), path);
  else if (want.is_number())
    expect(std::get<double>(got->value) == want.get<double>(), path);
  else
    expect(std::get<std::string>(got->value) == want.get<std::string>(), path);
}
/// The same for all values below a path.
void expect_values(const nlohmann::json& want, const std::vector<ml::FileValue>& got, const std::string& path) {
  if (!want.is_structured()) return expect_value(want, ml::find_value(got, path), path);
  for (const auto& member : want.items())
    expect_values(member.value(), got, path.empty() ? member.key() : path + "/" + member.key());
}

void container_read(Case& c) {
  const ml::JsonView config = c.config();
  const auto path = c.folder() / config["file"].as<std::string>();
  ml::WeightOptions options;
  if (config.contains("path")) options.path = config["path"].as<std::string>();
  const auto file = ml::open_weights(path, options);
  expect(file.format() == config["format"].as<std::string>(), "format " + file.format());
  constexpr std::array<std::string_view, 4> found_unasked{"", "state_dict", "model_state_dict", "model"};
  if (std::ranges::find(found_unasked, options.path.value_or("")) != found_unasked.end())
    expect(ml::open_weights(path).names() == file.names(), "without a path other tensors are found");
  for (const ml::TensorView& t : file.tensors()) {
    expect(type_name(t.dtype) == config["dtypes"].value_or(t.name, "nothing"), t.name + " is " + to_string(t.dtype));
    if (t.dtype == ml::DType::U32)
      c.out(t.name, t.shape, ml::values_of<std::int64_t>(t));
    else
      c.out_exactly(t.name, t);
  }
  for (const char* kind : {"scalars", "strings"}) {
    if (config.contains(kind)) expect_values(config[kind].json(), file.values(), "");
  }
  if (config.contains("opaque_config")) {
    auto fields = config["opaque_config"].json();
    const auto where = fields["where"].get<std::string>();
    fields.erase("where");
    fields.erase("module");
    expect_values(fields, file.values(), where);
  }
  if (config.contains("options")) {
    const auto beside = c.folder() / config.value_or("options_file", config["file"].as<std::string>() + "/config.json");
    expect_values(config["options"].json(), ml::read_options(beside), "");
  }
  if (config.contains("num_classes"))
    expect(file.tensor("encoder.muQuery").shape[0] == config["num_classes"].as<ml::Index>(), "number of classes");
}

/// 1 for each file that is refused with an error of the library.
void container_reject(Case& c) {
  std::vector<std::uint8_t> rejected;
  for (const auto& file : c.config()["files"].as<std::vector<std::string>>()) {
    try {
      ml::open_weights(c.folder() / c.config()["folder"].as<std::string>() / file);
      rejected.push_back(0);
    } catch (const ml::io_error& e) {
      rejected.push_back(1);
      if (std::getenv("MOTIONLANG_SHOW_REASONS") != nullptr) std::printf("       %s\n", e.what());
    }
  }
  c.out("rejected", rejected);
}

const Registration r1{"container read", "bytes", container_read};
const Registration r2{"container reject", "bytes", container_reject};

}  // namespace
