#define SUPPLE_ISA avx2
#include "supple/fem/tet4_kernels_impl.h"

namespace supple::fem {
extern const Tet4Kernels tet4_kernels_avx2;
const Tet4Kernels tet4_kernels_avx2 = avx2::kKernels;
}  // namespace supple::fem
