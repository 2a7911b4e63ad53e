#define SUPPLE_ISA avx2
#include "supple/fem/hex8_hyper_kernels_impl.h"

namespace supple::fem {
extern const Hex8HyperKernels hex8_hyper_kernels_avx2;
const Hex8HyperKernels hex8_hyper_kernels_avx2 = avx2::kHexHyperKernels;
}  // namespace supple::fem
