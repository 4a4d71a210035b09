// Five kernels at a fixed size, for counting their instructions: no clock, no threads, nothing random. See README.md.
//
// usage: instruction_counts KERNEL      with MOTIONLANG_KERNELS=avx2 below valgrind (count.py), which knows no AVX-512
#include <motionlang/backend/eigen.hpp>
#include <motionlang/core/rng.hpp>
#include <motionlang/kinematics/forward_batch.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>

namespace {

namespace ml = motionlang;
using ml::Index;
using B = ml::EigenBackend<float>;

ml::Tensor<B, 2> matrix(Index rows, Index columns) {
  ml::Philox rng{.seed = 1};
  return ml::Tensor<B, 2>::randn({rows, columns}, rng);
}
ml::Tensor<B, 1> vector(Index size) {
  ml::Philox rng{.seed = 2};
  return ml::Tensor<B, 1>::randn({size}, rng);
}

const auto x = matrix(52, 128);
auto weight = matrix(256, 128);
const auto bias = vector(256), gain = vector(128), offset = vector(128);
const auto qkv = matrix(52, 3 * 128);
const auto wide = matrix(52, 256);
std::vector<float> rot6d(256 * 144), root(256 * 3), joints(256 * 72);

struct Kernel {
  const char* name;
  void (*run)();
};
const Kernel kernels[] = {
    {"gemm", [] { ml::linear(x, weight, &bias); }},
    {"attention",
     [] {
       ml::self_attention(qkv, ml::Offsets{20, 32}, {.heads = 4});
     }},
    {"layer_norm", [] { ml::add_layer_norm(x, x, gain, offset); }},
    {"gelu", [] { ml::activate(wide, ml::Activation::gelu); }},
    {"forward_kinematics",
     [] { ml::forward_kinematics<float>(ml::smpl24_skeleton(), rot6d, root, std::span<float>(joints)); }}};

}  // namespace

/// Everything between call and return of this function is counted: count.py knows its name.
extern "C" [[gnu::noinline]] void counted(void (*kernel)()) {
  kernel();
  asm volatile("");  // no jump in place of the call
}

int main(int argc, char** argv) {
  ml::set_thread_count(1);
  B::prepare(weight.data());
  ml::Philox rng{.seed = 3};
  rng.normal(std::span<float>(rot6d));
  for (const Kernel& kernel : kernels) {
    if (argc != 2 || argv[1] != std::string_view(kernel.name)) continue;
    kernel.run();  // pools fill, kernels are chosen
    kernel.run();
    counted(kernel.run);
    return 0;
  }
  return 2;
}
