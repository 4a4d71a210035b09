// The README's motion as checksums: of the bits of its features, and of the text of its BVH file.
#include <motionlang/formats/bvh.hpp>
#include <motionlang/stmc.hpp>

#include <cstdio>

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

namespace {

unsigned long long hash(std::span<const std::byte> bytes) {  // FNV-1a
  unsigned long long h = 0xCBF29CE484222325u;
  for (const std::byte b : bytes) h = (h ^ static_cast<unsigned char>(b)) * 0x100000001B3u;
  return h;
}

}  // namespace

int main(int, char** arguments) {
  const auto stmc = ml::load_stmc<B>(arguments[1]);
  const auto timeline = ml::parse_timeline(
      "walk forward # 0.0 # 6.0 # legs\n"
      "raise both arms # 2.0 # 5.0 # left arm # right arm\n");
  const ml::Tensor<B, 2> features = stmc.generate(timeline, ml::Philox{.seed = 7});
  const std::string bvh = ml::format_bvh(ml::to_bvh(ml::stmc_motion(features)));
  std::printf("%td features %016llx, %zu characters of BVH %016llx\n", std::ssize(features.span()),
              hash(std::as_bytes(std::span(features.span()))), bvh.size(), hash(std::as_bytes(std::span(bvh))));
}
