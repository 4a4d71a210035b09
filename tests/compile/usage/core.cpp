// Names that the usage examples of core/, tensor/ and the headers of the first level use without declaring them.
#include "usage.hpp"

#include <motionlang/core/context.hpp>
#include <motionlang/core/fields.hpp>
#include <motionlang/diffusion/mdm_smpl.hpp>
#include <motionlang/fwd.hpp>
#include <motionlang/stmc.hpp>
#include <motionlang/tensor/print.hpp>
#include <motionlang/weights/module_file.hpp>
#include <motionlang/weights/weight_file.hpp>

#include "fwd.1.inc"

#include <iostream>

void context(const MdmSmplDenoiser<B>& model, const Sequences<B>& x, std::span<const Index> t,
             const TextFeatures<B>& text, const Philox& rng, std::uint64_t step) {
#include "core/context.1.inc"
}
void list_fields() {
#include "core/fields.1.inc"
}
void random(std::uint64_t step) {
#include "core/rng.1.inc"
}
void stmc() {
#include "stmc.1.inc"
}
void print() {
#include "tensor/print.1.inc"
}
void modules(Linear<B>& model) {
#include "weights/module_file.1.inc"
}
