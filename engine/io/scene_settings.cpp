#include "supple/io/scene_parts.h"

namespace supple::io {

SolverDef read_solver(const JsonNode& node) {
    require_keys(node,
                 {"integrator", "newton_iterations", "newton_tolerance", "cg_relative_tolerance", "cg_max_iterations", "preconditioner",
                  "precision", "linearise_at", "rayleigh_mass_1_s", "rayleigh_stiffness_s", "tangent", "operator", "step_budget_us", "contact_iterations"});
    SolverDef solver;
    if (node.has("integrator")) {
        const std::string kind = node.at("integrator").choice({"implicit_euler", "bdf2", "newmark", "static"});
        solver.integrator = kind == "bdf2" ? Integrator::bdf2 : kind == "newmark" ? Integrator::newmark : kind == "static" ? Integrator::quasi_static : Integrator::implicit_euler;
    }
    if (node.has("tangent")) solver.tangent = node.at("tangent").choice({"warped", "exact"}) == "exact" ? Tangent::exact : Tangent::warped;
    if (node.has("operator")) {
        const std::string kind = node.at("operator").choice({"auto", "assembled", "matrix_free"});
        solver.operator_kind = kind == "auto" ? OperatorKind::automatic : kind == "assembled" ? OperatorKind::assembled : OperatorKind::matrix_free;
    }
    if (node.has("newton_iterations")) solver.newton_iterations = int(node.at("newton_iterations").integer(1, 1000));
    if (node.has("newton_tolerance")) {
        const JsonNode tolerance = node.at("newton_tolerance");
        solver.newton_tolerance = tolerance.number();
        if (!(solver.newton_tolerance >= 0 && solver.newton_tolerance < 1)) tolerance.fail(tolerance.shown() + " is outside [0, 1)");
    }
    if (node.has("cg_relative_tolerance")) solver.cg_relative_tolerance = node.at("cg_relative_tolerance").number_between(0, 1);
    if (node.has("cg_max_iterations")) solver.cg_max_iterations = int(node.at("cg_max_iterations").integer(1, 1000000));
    if (node.has("preconditioner")) {
        const std::string kind =
            node.at("preconditioner").choice({"auto", "auto_timed", "block_jacobi", "lattice_multigrid", "scalar_laplacian", "direct"});
        solver.preconditioner = kind == "auto"                ? PreconditionerKind::automatic
                                : kind == "auto_timed"        ? PreconditionerKind::automatic_timed
                                : kind == "block_jacobi"      ? PreconditionerKind::block_jacobi
                                : kind == "lattice_multigrid" ? PreconditionerKind::lattice_multigrid
                                : kind == "scalar_laplacian"  ? PreconditionerKind::scalar_laplacian
                                                              : PreconditionerKind::direct;
    }
    if (node.has("precision")) {
        solver.precision = node.at("precision").choice({"single", "double"}) == "single" ? Precision::single : Precision::double_;
    }
    if (node.has("linearise_at")) {
        const std::string at = node.at("linearise_at").choice({"prediction", "current"});
        solver.linearise_at = at == "prediction" ? LineariseAt::prediction : LineariseAt::current;
    }
    if (node.has("contact_iterations")) solver.contact_iterations = int(node.at("contact_iterations").integer(1, 1000));
    if (node.has("step_budget_us")) solver.step_budget_us = node.at("step_budget_us").number(0, 1e9);
    if (node.has("rayleigh_mass_1_s")) solver.rayleigh_mass_1_s = node.at("rayleigh_mass_1_s").number(0, 1e6);
    if (node.has("rayleigh_stiffness_s")) solver.rayleigh_stiffness_s = node.at("rayleigh_stiffness_s").number(0, 1e3);
    return solver;
}

SceneCamera read_camera(const JsonNode& node) {
    node.require_object({"eye_m", "target_m", "fov_deg"});
    SceneCamera camera{node.at("eye_m").vec3(1e9), node.at("target_m").vec3(1e9), 40};
    if (node.has("fov_deg")) camera.fov_deg = node.at("fov_deg").number(1, 170);
    if (camera.eye_m == camera.target_m) node.at("target_m").fail("target_m equals eye_m; the camera must look somewhere");
    return camera;
}

}  // namespace supple::io
