// Cases and comparisons of the golden runner (golden.hpp).
#include "golden.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace golden {

namespace {

nlohmann::json metadata_json(const ml::SafetensorsFile& file, const std::string& key) {
  const auto entry = file.metadata().find(key);
  return entry == file.metadata().end() ? nlohmann::json() : ml::parse_json(entry->second, file.name() + " " + key);
}

bool is_gradient(const std::string& tensor) { return tensor.starts_with("grad/"); }
bool is_result(const std::string& tensor) { return tensor.starts_with("out/") || is_gradient(tensor); }

}  // namespace

Case::Case(const std::filesystem::path& path)
    : file_(ml::SafetensorsFile::open(path)),
      folder_(path.parent_path()),
      name_(path.parent_path().filename() / path.stem()) {
  const auto function = file_.metadata().find("function");
  if (function == file_.metadata().end()) ml::raise<ml::io_error>(403, name_, ": no function in the metadata");
  function_ = function->second;
  config_ = metadata_json(file_, "config");
  text_ = metadata_json(file_, "text");
  tolerance_ = metadata_json(file_, "tolerance");
}

std::vector<std::string> Case::names(const std::string& prefix) const {
  std::vector<std::string> out;
  for (const auto& t : file_.tensors()) {
    if (t.name.starts_with(prefix)) out.push_back(t.name.substr(prefix.size()));
  }
  return out;
}

bool Case::in_double() const {
  if (config().value_or("dtype", "") == "float64") return true;
  const auto any = [&](ml::DType type) {
    return std::ranges::any_of(file_.tensors(),
                               [&](const ml::TensorView& t) { return !is_result(t.name) && t.dtype == type; });
  };
  return any(ml::DType::F64) && !any(ml::DType::F32);
}

/// {"atol", "rtol"} for all; or by name: the tensor's full name first (grad/...), then its key, then "default".
Case::Tolerance Case::tolerance(const std::string& tensor, const std::string& key) const {
  const auto read = [](const nlohmann::json& entry) {
    return Tolerance{entry.value("atol", 1e-5), entry.value("rtol", 1e-5)};
  };
  if (!tolerance_.is_object()) return {};
  if (tolerance_.contains("atol") && tolerance_["atol"].is_number()) return read(tolerance_);
  for (const std::string& entry : {tensor, key, std::string("default")}) {
    if (tolerance_.contains(entry)) return read(tolerance_[entry]);
  }
  return {};
}

void Case::result(const std::string& tensor, const std::string& key, const ml::Shape& shape,
                  std::span<const double> got) {
  const ml::TensorView* want = file_.find(tensor);
  if (want == nullptr && !is_gradient(tensor)) return;
  Comparison c{.name = tensor};
  produced_.insert(tensor);
  if (want == nullptr) {
    c.failure = "is not in the file";
  } else if (want->shape != shape || static_cast<std::size_t>(shape.count()) != got.size()) {
    c.failure = ml::concat_text("shape ", shape, " with ", got.size(), " values, wanted ", want->shape);
  } else {
    const auto [atol, rtol] = tolerance(tensor, key);
    const auto wanted = ml::values_of<double>(*want);
    for (std::size_t i = 0; i < got.size(); ++i) {
      if (got[i] == wanted[i]) continue;  // infinities, too
      const double error = std::abs(got[i] - wanted[i]), allowed = atol + rtol * std::abs(wanted[i]);
      if (!std::isfinite(error)) {  // no tolerance of an infinity lets other numbers pass
        c.failure = ml::concat_text("element ", i, ": got ", got[i], ", wanted ", wanted[i]);
        break;
      }
      c.error = std::max(c.error, error);
      if (error > 0)
        c.ratio = std::max(c.ratio, allowed > 0 ? error / allowed : std::numeric_limits<double>::infinity());
    }
  }
  comparisons_.push_back(c);
}

void Case::out_exactly(const std::string& name, const ml::TensorView& got) {
  Comparison c{.name = "out/" + name};
  produced_.insert(c.name);
  const ml::TensorView* want = file_.find(c.name);
  const ml::DType type = got.dtype == ml::DType::BOOL ? ml::DType::U8 : got.dtype;
  if (want == nullptr)
    c.failure = "is not in the file";
  else if (want->shape != got.shape || want->dtype != type)
    c.failure = ml::concat_text("is ", type, " ", got.shape, ", wanted ", want->dtype, " ", want->shape);
  else if (!std::equal(got.bytes.begin(), got.bytes.end(), want->bytes.begin(), want->bytes.end()))
    c.failure = "has other bits";
  comparisons_.push_back(c);
}

std::vector<Comparison> Case::finish() const {
  std::vector<Comparison> all = comparisons_;
  if (std::ranges::none_of(file_.tensors(), [](const auto& t) { return is_result(t.name); }))
    all.push_back({.name = name_, .failure = "has no out/ and no grad/ to compare with"});
  for (const auto& t : file_.tensors()) {
    if (is_result(t.name) && !produced_.contains(t.name))
      all.push_back({.name = t.name, .failure = "was not produced"});
  }
  return all;
}

}  // namespace golden
