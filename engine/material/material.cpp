#include "supple/material/material.h"

#include <cmath>

#include "supple/base/error.h"

namespace supple {

Lame lame_parameters(double young_pa, double poisson, const std::string& where) {
    if (!(std::isfinite(young_pa) && young_pa > 0)) {
        throw Error(ErrorCode::invalid_argument, where + ".young_pa",
                    to_text(young_pa) + " is not a Young's modulus; give a finite number of pascals above 0 (soft tissue 1e3 to 1e5, rubber 1e6)");
    }
    if (!(poisson > -1 && poisson < 0.5)) {
        throw Error(ErrorCode::invalid_argument, where + ".poisson",
                    to_text(poisson) + " is outside (-1, 0.5); nearly incompressible matter has 0.45 to 0.499");
    }
    return {young_pa * poisson / ((1 + poisson) * (1 - 2 * poisson)), young_pa / (2 * (1 + poisson))};
}

}  // namespace supple
