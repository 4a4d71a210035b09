// The products of products.cpp in oneDNN: weights are brought once into the order that it likes best, bias + GELU are
// in its epilogue. In bfloat16 it is given activations that are bfloat16 already, where ours begin and end in float.
//
// usage: bench_products_onednn [THREADS] [--bf16] [product product_gelu product_batched ...]
#include <omp.h>

#include <algorithm>
#include <oneapi/dnnl/dnnl.hpp>
#include <random>
#include <unordered_map>

#include "bench.hpp"
#include "product_shapes.hpp"

namespace {

using namespace bench;
using dnnl::memory;
using Type = memory::data_type;
using Tag = memory::format_tag;

class OneDnn {
 public:
  /// gelu: with bias and GELU. packed: the right factor may stand in any order.
  void measure(const std::string& work, const Size& s, bool transposed, bool packed, bool gelu) {
    const bool many = s.count > 1;
    const auto dims = [&](long rows, long columns) {
      return many ? memory::dims{s.count, rows, columns} : memory::dims{rows, columns};
    };
    const Tag order = many ? Tag::abc : Tag::ab, turned = many ? Tag::acb : Tag::ba;
    const memory a = random({dims(s.rows, s.inner), Type::f32, order});
    const memory b = random({dims(s.inner, s.columns), Type::f32, transposed ? turned : order});
    const memory bias = random({dims(1, s.columns), Type::f32, order});
    const memory::desc result(dims(s.rows, s.columns), Type::f32, order);

    const Type type = ml::product_precision() == ml::Precision::bf16 ? Type::bf16 : Type::f32;
    const memory::desc left(dims(s.rows, s.inner), type, order);
    const memory::desc right(dims(s.inner, s.columns), type, packed ? Tag::any : transposed ? turned : order);
    dnnl::primitive_attr attributes;
    if (gelu) {
      dnnl::post_ops after;
      after.append_eltwise(1, dnnl::algorithm::eltwise_gelu_erf, 0, 0);
      attributes.set_post_ops(after);
    }
    const auto wanted =
        gelu ? dnnl::matmul::desc(left, right, bias.get_desc(), result) : dnnl::matmul::desc(left, right, result);
    const dnnl::matmul::primitive_desc chosen(wanted, attributes, engine_);
    const dnnl::matmul product(chosen);
    std::unordered_map<int, memory> arguments{{DNNL_ARG_SRC, reordered(a, chosen.src_desc())},
                                              {DNNL_ARG_WEIGHTS, reordered(b, chosen.weights_desc())},
                                              {DNNL_ARG_DST, memory(result, engine_)}};
    if (gelu) arguments[DNNL_ARG_BIAS] = bias;
    report(work, s.name(), 0,
           [&] {
             product.execute(stream_, arguments);
             stream_.wait();
           },
           {.seconds = 0.3, .variant = "onednn"});
  }

 private:
  memory random(const memory::desc& description) {
    memory out(description, engine_);
    auto* at = static_cast<float*>(out.get_data_handle());
    std::uniform_real_distribution<float> number(-1, 1);
    std::generate_n(at, description.get_size() / sizeof(float), [&] { return number(rng_); });
    return out;
  }
  memory reordered(memory from, const memory::desc& description) {
    memory to(description, engine_);
    dnnl::reorder(from, to).execute(stream_, from, to);
    stream_.wait();
    return to;
  }

  dnnl::engine engine_{dnnl::engine::kind::cpu, 0};
  dnnl::stream stream_{engine_};
  std::mt19937 rng_{1};
};

}  // namespace

int main(int argc, char** argv) {
  const Arguments asked_for(argc, argv);
  omp_set_num_threads(static_cast<int>(ml::thread_count()));
  OneDnn onednn;
  for (const Size& s : layers) {
    if (asked_for.asked("product")) onednn.measure("product", s, true, true, false);
    if (asked_for.asked("product_gelu")) onednn.measure("product_gelu", s, true, true, true);
  }
  if (asked_for.asked("product_batched")) {
    for (const Size& s : heads) onednn.measure("product_batched", s, s.rows == s.columns, false, false);
  }
}
