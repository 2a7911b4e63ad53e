#define SUPPLE_ISA avx512
#include "supple/fem/hex8_hyper_kernels_impl.h"

namespace supple::fem {
extern const Hex8HyperKernels hex8_hyper_kernels_avx512;
const Hex8HyperKernels hex8_hyper_kernels_avx512 = avx512::kHexHyperKernels;
}  // namespace supple::fem
