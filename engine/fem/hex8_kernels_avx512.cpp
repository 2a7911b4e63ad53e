#define SUPPLE_ISA avx512
#include "supple/fem/hex8_kernels_impl.h"

namespace supple::fem {
extern const Hex8Kernels hex8_kernels_avx512;
const Hex8Kernels hex8_kernels_avx512 = avx512::kHexKernels;
}  // namespace supple::fem
