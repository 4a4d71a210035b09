// The products that products.cpp and its peers measure.
#pragma once

#include <string>

namespace bench {

/// rows x inner x columns, so many times.
struct Size {
  long rows, inner, columns, count = 1;

  double gflop() const { return 2e-9 * static_cast<double>(rows * inner * columns * count); }
  std::string name() const {
    auto text = std::to_string(rows) + "x" + std::to_string(inner) + "x" + std::to_string(columns);
    return count == 1 ? text : text + " x" + std::to_string(count);
  }
};
/// Denoiser, autoencoders, DistilBERT, CLIP; frames into the model; one token.
inline constexpr Size layers[] = {{204, 512, 512},   {408, 512, 1536},  {408, 512, 1024}, {408, 1024, 512},
                                  {1632, 512, 1536}, {3264, 1024, 512}, {202, 256, 256},  {202, 1024, 256},
                                  {6464, 256, 1024}, {32, 768, 3072},   {32, 3072, 768},  {1024, 768, 3072},
                                  {77, 512, 2048},   {77, 2048, 512},   {200, 205, 512},  {1, 512, 2048}};
/// q k^T and weights v of attention.
inline constexpr Size heads[] = {{204, 128, 204, 4}, {204, 204, 128, 4}, {202, 64, 202, 128}, {202, 202, 64, 128}};

}  // namespace bench
