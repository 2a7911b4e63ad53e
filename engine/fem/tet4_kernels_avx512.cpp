#define SUPPLE_ISA avx512
#include "supple/fem/tet4_kernels_impl.h"

namespace supple::fem {
extern const Tet4Kernels tet4_kernels_avx512;
const Tet4Kernels tet4_kernels_avx512 = avx512::kKernels;
}  // namespace supple::fem
