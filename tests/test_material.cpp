#include "supple/material/material.h"

#include <gtest/gtest.h>

#include <cmath>

#include "supple/base/error.h"

namespace supple {
namespace {

TEST(MaterialLame, FollowsYoungAndPoisson) {
    const Lame l = lame_parameters(2e5, 0.4, "m");
    EXPECT_NEAR(l.mu_pa, 71428.571428571428, 1e-9);
    EXPECT_NEAR(l.lambda_pa, 285714.28571428571, 1e-9);
    const Lame cork = lame_parameters(1e6, 0, "m");
    EXPECT_EQ(cork.lambda_pa, 0);
    EXPECT_EQ(cork.mu_pa, 5e5);
    // Back again: E = mu (3 lambda + 2 mu) / (lambda + mu), nu = lambda / (2 (lambda + mu)), auxetic matter included.
    for (const double nu : {-0.9, -0.3, 0.1, 0.33, 0.4999}) {
        const Lame a = lame_parameters(3e4, nu, "m");
        EXPECT_NEAR(a.mu_pa * (3 * a.lambda_pa + 2 * a.mu_pa) / (a.lambda_pa + a.mu_pa), 3e4, 1e-6) << nu;
        EXPECT_NEAR(a.lambda_pa / (2 * (a.lambda_pa + a.mu_pa)), nu, 1e-12) << nu;
    }
}

void expect_refused(double young, double poisson, const std::string& where) {
    try {
        (void)lame_parameters(young, poisson, "BodyDef.material");
        ADD_FAILURE() << "accepted E = " << young << ", nu = " << poisson;
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
        EXPECT_EQ(e.where(), "BodyDef.material." + where);
    }
}

TEST(MaterialLame, RefusesWhatIsNoMaterialAndNamesTheField) {
    for (const double young : {0.0, -1.0, std::nan(""), HUGE_VAL}) expect_refused(young, 0.3, "young_pa");
    for (const double poisson : {-1.0, 0.5, 0.6, std::nan(""), HUGE_VAL}) expect_refused(1e5, poisson, "poisson");
}

}  // namespace
}  // namespace supple
