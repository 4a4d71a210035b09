// AnyDenoiser is the denoiser that it holds, and denoisers with several texts for a sequence.
#include <motionlang/diffusion/any_denoiser.hpp>

#include <doctest/doctest.h>

#include <motionlang/diffusion/denoiser.hpp>

#include "../../support/small_denoisers.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets;
using small::B;

namespace {

ml::TextFeatures<B> texts(Index count) {
  return {.tokens = {tensors::normal<B, 2>({count, 12}, 3), Offsets::equal(count, 1)},
          .end_position = std::vector<Index>(static_cast<std::size_t>(count), 0),
          .padded_tokens = 1};
}

template <class D, class Put>
void check_same(Put put) {
  const D own = small::denoiser_of<D>(ml::Philox{.seed = 5});
  ml::AnyDenoiser<B> any;
  put(any, own);
  CHECK(any.traits().crop_frames == own.traits().crop_frames);
  CHECK(any.traits().prediction == own.traits().prediction);

  const Offsets frames{small::crop_frames, small::crop_frames}, uses{2, 1};
  const ml::Sequences<B> x(tensors::normal<B, 2>({frames.rows(), 205}, 4), frames);
  const std::vector<Index> two{3, 3}, three{3, 3, 3};
  CHECK(tensors::same_bits(any(x, two, texts(2)).rows, own(x, two, texts(2)).rows));

  const auto with = [&](const auto& d) {
    return ml::denoise_with_texts<B>(d, x, uses, three, ml::encoded_text<B>(d, texts(3))).rows;
  };
  CHECK(tensors::same_bits(with(any), with(own)));
  // Everything that the texts of a sequence share is computed once, with the bits of separate runs.
  CHECK(tensors::same_bits(with(own), own(ml::repeat_sequences(x, uses), three, texts(3)).rows));
}

}  // namespace

TEST_CASE("AnyDenoiser calculates as the denoiser that it holds, also with several texts for a sequence") {
  check_same<ml::MdmSmplDenoiser<B>>([](auto& any, const auto& d) { any.mdm_smpl = d; });
  check_same<ml::MdmDenoiser<B>>([](auto& any, const auto& d) { any.mdm = d; });
  check_same<ml::MotionDiffuseDenoiser<B>>([](auto& any, const auto& d) { any.motiondiffuse = d; });
}

TEST_CASE("the parameters of AnyDenoiser are those of its member, behind its name") {
  ml::AnyDenoiser<B> any;
  CHECK(ml::parameter_count(any) == 0);
  const auto own = small::denoiser_of<ml::MdmDenoiser<B>>(ml::Philox{.seed = 5});
  any.mdm = own;
  CHECK(ml::parameter_count(any) == ml::parameter_count(own));
  bool all = true;
  ml::visit_tensors(any, [&](const std::string& path, const auto&) { all = all && path.starts_with("mdm."); });
  CHECK(all);
}
