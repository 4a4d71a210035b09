// Golden functions: the generators of PyTorch, NumPy and CPython.
#include <numeric>

#include <motionlang/core/numpy_random.hpp>
#include <motionlang/core/python_random.hpp>
#include <motionlang/core/torch_random.hpp>

#include "golden.hpp"
#include "seeds.hpp"

namespace {

using golden::Case, golden::Registration, golden::seeded, golden::three_digits;
namespace ml = motionlang;

template <class T, class F>
std::vector<T> repeat(ml::Index count, F draw) {
  std::vector<T> out;
  for (ml::Index i = 0; i < count; ++i) out.push_back(static_cast<T>(draw()));
  return out;
}

std::vector<ml::Index> counted(ml::Index n) {
  std::vector<ml::Index> out(static_cast<std::size_t>(n));
  std::iota(out.begin(), out.end(), ml::Index{0});
  return out;
}

template <class S>
void torch_tensors(Case& c, ml::TorchRandom& rng) {
  const auto shapes = c.config()["shapes"];
  const bool normal = c.config()["distribution"].as<std::string>() == "normal";
  for (ml::Index i = 0; i < shapes.size(); ++i) {
    const ml::Shape shape{std::span<const ml::Index>(shapes[i].as<std::vector<ml::Index>>())};
    std::vector<S> values(static_cast<std::size_t>(shape.count()));
    normal ? rng.normal(std::span<S>(values)) : rng.uniform(std::span<S>(values));
    c.out(three_digits(i), shape, values);
  }
}

const Registration torch_random{"torch random numbers", "double", [](Case& c) {
                                  auto rng = seeded<ml::TorchRandom>(c.config()["seed"]);
                                  c.config()["dtype"].as<std::string>() == "float64" ? torch_tensors<double>(c, rng)
                                                                                     : torch_tensors<float>(c, rng);
                                }};

const Registration numpy_random{
    "numpy random numbers", "double", [](Case& c) {
      ml::NumpyRandom rng(c.config()["seed"].as<std::uint32_t>());
      const auto calls = c.config()["calls"];
      for (ml::Index i = 0; i < calls.size(); ++i) {
        const auto call = calls[i];
        const auto kind = call[0].as<std::string>();
        const auto number = [&](ml::Index k) { return call[k].as<ml::Index>(); };
        if (kind == "randint") {
          const ml::Index count = number(3);
          const auto draw = [&] { return rng.randint(number(1), number(2)); };
          const auto values = repeat<ml::Index>(std::max<ml::Index>(count, 1), draw);
          c.out(three_digits(i), count == 0 ? ml::Shape{} : ml::Shape{count}, values);
        } else if (kind == "shuffle") {
          auto list = counted(number(1));
          rng.shuffle(list);
          c.out(three_digits(i), list);
        } else if (kind == "permutation") {
          c.out(three_digits(i), rng.permutation(number(1)));
        } else if (kind == "choice") {
          c.out(three_digits(i), rng.choice(number(1), number(2)));
        } else if (kind == "rand" || kind == "randn") {
          c.out(three_digits(i), repeat<double>(number(1), [&] { return kind == "rand" ? rng.rand() : rng.randn(); }));
        } else {
          ml::raise<ml::config_error>(103, "unknown call '", kind, "'");
        }
      }
    }};

const Registration python_random_numbers{
    "python random numbers", "double", [](Case& c) {
      auto rng = seeded<ml::PythonRandom>(c.config()["seed"]);
      const auto calls = c.config()["calls"];
      for (ml::Index i = 0; i < calls.size(); ++i) {
        const auto call = calls[i];
        const auto kind = call[0].as<std::string>();
        const auto number = [&](ml::Index k) { return call[k].as<ml::Index>(); };
        const auto real = [&](ml::Index k) { return call[k].as<double>(); };
        if (kind == "randint") {
          c.out(three_digits(i), repeat<ml::Index>(number(3), [&] { return rng.randint(number(1), number(2)); }));
        } else if (kind == "shuffle") {
          auto list = counted(number(1));
          rng.shuffle(list);
          c.out(three_digits(i), list);
        } else if (kind == "random") {
          c.out(three_digits(i), repeat<double>(number(1), [&] { return rng.random(); }));
        } else if (kind == "choice") {
          c.out(three_digits(i), repeat<ml::Index>(number(2), [&] { return rng.choice(number(1)); }));
        } else if (kind == "getrandbits") {
          c.out(three_digits(i), repeat<ml::Index>(number(2), [&] { return rng.getrandbits(call[1].as<int>()); }));
        } else if (kind == "gauss") {
          c.out(three_digits(i), repeat<double>(number(3), [&] { return rng.gauss(real(1), real(2)); }));
        } else if (kind == "uniform") {
          c.out(three_digits(i), repeat<double>(number(3), [&] { return rng.uniform(real(1), real(2)); }));
        } else if (kind == "sample") {
          c.out(three_digits(i), rng.sample(number(1), number(2)));
        } else if (kind == "sample_counts") {
          const auto counts = call[1].as<std::vector<ml::Index>>();
          c.out(three_digits(i), rng.sample_counts(counts, number(2)));
        } else {
          ml::raise<ml::config_error>(103, "unknown call '", kind, "'");
        }
      }
    }};

}  // namespace
