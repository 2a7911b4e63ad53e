#include "supple/math/isa.h"

namespace supple {

bool is_supported(Isa isa) {
    switch (isa) {
        case Isa::scalar:
        case Isa::baseline: return true;
#if defined(SUPPLE_X86_KERNELS)
        case Isa::avx2: return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
        case Isa::avx512:
            return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
                   __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("fma");
#else
        case Isa::avx2:
        case Isa::avx512: return false;
#endif
    }
    return false;
}

Isa best_isa() {
    Isa best = Isa::scalar;
    for (const Isa isa : kAllIsas) {
        if (is_supported(isa)) best = isa;
    }
    return best;
}

std::string_view name(Isa isa) {
    switch (isa) {
        case Isa::scalar: return "scalar";
        case Isa::baseline: return "baseline";
        case Isa::avx2: return "avx2";
        case Isa::avx512: return "avx512";
    }
    return "unknown";
}

}  // namespace supple
