// The choice of kernels by what the processor has. What MOTIONLANG_KERNELS asks for is read once by a process.
#include <doctest/doctest.h>

#include <motionlang/core/instruction_set.hpp>

#include <utility>

namespace ml = motionlang;
using ml::detail::Isa;

TEST_CASE("each instruction set includes those before it, and the wanted one is there") {
  CHECK(ml::detail::processor_has(Isa::portable));
  for (const auto& [more, less] :
       {std::pair(Isa::amx, Isa::avx512), {Isa::avx512_bf16, Isa::avx512}, {Isa::avx512, Isa::avx2}}) {
    if (ml::detail::processor_has(more)) CHECK(ml::detail::processor_has(less));
  }
  const Isa wanted = ml::detail::wanted_isa();
  CHECK((wanted == Isa::best || ml::detail::processor_has(wanted)));
#ifdef MOTIONLANG_WIDER_COPIES
  const Isa widest = ml::detail::widest_vectors();
  CHECK(ml::detail::processor_has(widest));
  CHECK((widest == Isa::portable || widest == Isa::avx2 || widest == Isa::avx512));
  if (wanted == Isa::best && ml::detail::processor_has(Isa::avx512)) CHECK(widest == Isa::avx512);
#endif
}
