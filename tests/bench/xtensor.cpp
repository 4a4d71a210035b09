// The same models over the xtensor backend and over the Eigen backend, in turns: rows of the variant "eigen" are the
// peer.
//
// usage: bench_xtensor [THREADS] [xtensor]
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/xtensor.hpp>

#include "networks.hpp"

namespace {

using namespace bench;
using Eigen_ = ml::EigenBackend<float>;
using Xtensor = ml::XtensorBackend<float>;

template <class Over, class Peer>
void compare(const std::string& config, const Over& run, const Peer& peer) {
  for (int turn = 0; turn < 3; ++turn) {
    report("xtensor", config, run.gflop(), run, {.seconds = 0.5});
    report("xtensor", config, peer.gflop(), peer, {.seconds = 0.5, .variant = "eigen"});
  }
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments read(argc, argv);
  const auto crops = equal(1, 200);
  compare("denoising step 2 crops T=200", MdmStep<Xtensor>(crops), MdmStep<Eigen_>(crops));
  compare("TMR encoder B=1 T=200", TmrEncoding<Xtensor>(1), TmrEncoding<Eigen_>(1));
  compare("TEMOS decoder B=1 T=200", TemosDecoding<Xtensor>(1), TemosDecoding<Eigen_>(1));
  compare("ACTOR decoder B=1 T=60", ActorDecoding<Xtensor>(1), ActorDecoding<Eigen_>(1));
  compare("MotionDiffuse step B=1 T=196", MotionDiffuseStep<Xtensor>(1), MotionDiffuseStep<Eigen_>(1));
  compare("Guo's evaluator 32 motions T=196", GuoMotions<Xtensor>(), GuoMotions<Eigen_>());
  compare("TM2T to tokens B=1 T=196", ToTokens<Xtensor>(1), ToTokens<Eigen_>(1));
  compare("TM2T from tokens B=1 T=196", FromTokens<Xtensor>(1), FromTokens<Eigen_>(1));
  compare("TM2T writes B=1 49 tokens", Writing<Xtensor>(1), Writing<Eigen_>(1));
  compare("ST-GCN B=1 T=60", StGcnRun<Xtensor>(1), StGcnRun<Eigen_>(1));
}
