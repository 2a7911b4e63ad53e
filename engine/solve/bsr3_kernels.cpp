#include "supple/solve/bsr3_kernels.h"

namespace supple::solve {

extern const Bsr3Kernels<float> bsr3_kernels_f_scalar, bsr3_kernels_f_baseline;
extern const Bsr3Kernels<double> bsr3_kernels_d_scalar, bsr3_kernels_d_baseline;
#if defined(SUPPLE_X86_KERNELS)
extern const Bsr3Kernels<float> bsr3_kernels_f_avx2, bsr3_kernels_f_avx512;
extern const Bsr3Kernels<double> bsr3_kernels_d_avx2, bsr3_kernels_d_avx512;
#endif

template <>
const Bsr3Kernels<float>& bsr3_kernels<float>(Isa isa) {
    switch (isa) {
#if defined(SUPPLE_X86_KERNELS)
        case Isa::avx2: return bsr3_kernels_f_avx2;
        case Isa::avx512: return bsr3_kernels_f_avx512;
#endif
        case Isa::scalar: return bsr3_kernels_f_scalar;
        default: return bsr3_kernels_f_baseline;
    }
}

template <>
const Bsr3Kernels<double>& bsr3_kernels<double>(Isa isa) {
    switch (isa) {
#if defined(SUPPLE_X86_KERNELS)
        case Isa::avx2: return bsr3_kernels_d_avx2;
        case Isa::avx512: return bsr3_kernels_d_avx512;
#endif
        case Isa::scalar: return bsr3_kernels_d_scalar;
        default: return bsr3_kernels_d_baseline;
    }
}

}  // namespace supple::solve
