#define SUPPLE_ISA avx512
#include "supple/solve/bsr3_kernels_impl.h"

namespace supple::solve {
extern const Bsr3Kernels<float> bsr3_kernels_f_avx512;
extern const Bsr3Kernels<double> bsr3_kernels_d_avx512;
const Bsr3Kernels<float> bsr3_kernels_f_avx512 = avx512::kKernels<float>;
const Bsr3Kernels<double> bsr3_kernels_d_avx512 = avx512::kKernels<double>;
}  // namespace supple::solve
