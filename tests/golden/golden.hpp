// The golden runner's frame: a case, the registry of functions, the comparison.
//
// A handler computes one published function: it reads config, in/, noise/ and weights/ of the case and hands over every
// out/ and grad/. It is registered under the function's name once for each numeric variant it serves:
//
//     void lengths_to_mask(golden::Case& c) { ... c.out("mask", shape, values); }
//     const golden::Registration r{"lengths to mask", "double", lengths_to_mask};
//
// A variant is a label ("double", "float", "reference<double>", "eigen<float>", ...); each gets a line of its own.
// Those in float do not serve cases in double.
#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <motionlang/file/json.hpp>
#include <motionlang/file/safetensors.hpp>

namespace golden {

namespace ml = motionlang;

/// "000", "001", ...: names of tensors that are numbered; of more than a thousand, "1000", ...
inline std::string three_digits(ml::Index n) {
  const std::string digits = std::to_string(n);
  return std::string(3 - std::min<std::size_t>(3, digits.size()), '0') + digits;
}

/// How far one output is from what is wanted. `ratio` = largest |got - want| / (atol + rtol |want|); at most 1 passes.
struct Comparison {
  std::string name;
  double error = 0, ratio = 0;
  std::string failure{};  // wrong shape, NaN, not in the file
};

/// One file, opened.
class Case {
 public:
  explicit Case(const std::filesystem::path& path);

  const std::string& name() const { return name_; }
  /// Where the file lies: cases may come with other files.
  const std::filesystem::path& folder() const { return folder_; }
  const std::string& function() const { return function_; }

  // ---- inputs -------------------------------------------------------------------------------------------------------
  ml::JsonView config() const { return ml::JsonView(config_, name_ + " config"); }
  ml::JsonView text() const { return ml::JsonView(text_, name_ + " text"); }

  /// Tensors by full name: "in/x", "noise/000", "weights/encoder.muQuery".
  bool has(const std::string& tensor) const { return file_.find(tensor) != nullptr; }
  const ml::TensorView& tensor(const std::string& name) const { return file_.tensor(name); }
  ml::Shape shape(const std::string& name) const { return tensor(name).shape; }
  template <class T>
  std::vector<T> values(const std::string& name) const {
    return ml::values_of<T>(tensor(name));
  }
  template <class T>
  T scalar(const std::string& name) const {
    return values<T>(name).at(0);
  }
  /// Names below a prefix, without it: names("weights/").
  std::vector<std::string> names(const std::string& prefix) const;
  const ml::SafetensorsFile& file() const { return file_; }
  /// True if the published numbers were computed in double: the config says so, or all numbers with a fraction are.
  bool in_double() const;

  // ---- results ------------------------------------------------------------------------------------------------------
  /// Compares an output. Every one in the file has to be handed over. Others are not looked at (a source does not have
  /// every intermediate result), but a gradient that the file lacks is an error: those parameters are not trained.
  template <class T>
  void out(const std::string& name, const ml::Shape& shape, std::span<const T> values) {
    result("out/" + name, name, shape, values);
  }
  template <class T>
  void out(const std::string& name, const ml::Shape& shape, const std::vector<T>& values) {
    out(name, shape, std::span<const T>(values));
  }
  template <class T>
  void out(const std::string& name, const std::vector<T>& values) {
    out(name, {static_cast<ml::Index>(values.size())}, values);
  }
  void out_scalar(const std::string& name, double value) { out(name, {}, std::span<const double>(&value, 1)); }
  void out_text(const std::string& name, std::string_view text) {
    out(name, std::vector<std::uint8_t>(text.begin(), text.end()));
  }
  /// Compares an output bit for bit: same type (booleans are bytes in the cases), same shape, same bytes.
  void out_exactly(const std::string& name, const ml::TensorView& got);
  template <class T>
  void grad(const std::string& key, const ml::Shape& shape, std::span<const T> values) {
    result("grad/" + key, key, shape, values);
  }
  /// Does not compare an output whose record is known to be wrong: README.md names the case and has the proof.
  void leave_out(const std::string& name) { left_out_ += produced_.insert("out/" + name).second ? 1 : 0; }
  /// True if the file holds this output. Large cases lack intermediate ones.
  bool wants(const std::string& output) const { return has("out/" + output); }

  // ---- for the runner -----------------------------------------------------------------------------------------------
  void begin_variant() { comparisons_.clear(), produced_.clear(), left_out_ = 0; }
  int left_out() const { return left_out_; }
  /// The comparisons so far and a failure for every output that no handler produced.
  std::vector<Comparison> finish() const;

 private:
  struct Tolerance {
    double atol = 1e-5, rtol = 1e-5;
  };
  Tolerance tolerance(const std::string& tensor, const std::string& key) const;
  void result(const std::string& tensor, const std::string& key, const ml::Shape& shape, std::span<const double> got);
  template <class T>
  void result(const std::string& tensor, const std::string& key, const ml::Shape& shape, std::span<const T> got) {
    const std::vector<double> wide(got.begin(), got.end());  // integers of the cases are below 2^53
    result(tensor, key, shape, std::span<const double>(wide));
  }

  ml::SafetensorsFile file_;
  std::filesystem::path folder_;
  std::string name_, function_;
  nlohmann::json config_, text_, tolerance_;
  std::vector<Comparison> comparisons_;
  std::set<std::string> produced_;
  int left_out_ = 0;
};

using Handler = std::function<void(Case&)>;

/// Function name -> (variant, handler) in order of registration.
using Registry = std::map<std::string, std::vector<std::pair<std::string, Handler>>>;
inline Registry& registry() {
  static Registry functions;
  return functions;
}

struct Registration {
  Registration(const std::string& function, const std::string& variant, Handler handler) {
    registry()[function].emplace_back(variant, std::move(handler));
  }
};

}  // namespace golden
