// A tree of bodies with closed loops, moved by Runge-Kutta steps of order 4.
#include <cmath>
#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/constrained-dynamics.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/proximal.hpp>
#include <string>
#include <vector>

using namespace pinocchio;
using Vector = Eigen::VectorXd;
using Point = Eigen::Vector3d;
using Loops = PINOCCHIO_ALIGNED_STD_VECTOR(RigidConstraintModel);
using LoopData = PINOCCHIO_ALIGNED_STD_VECTOR(RigidConstraintData);

struct Spring {
    JointIndex one, other;
    Point at_one, at_other;
    double stiffness, length, damping;
};

// bodies: parent (-1: ground), kind (0 to 2: hinge about x, y, z; 3 to 5: slide along it), ten numbers: at, mass, centre of mass,
// inertia about it along x, y, z.
// loops: body, place, body, place. springs: body (-1: ground), place, body, place, stiffness, length, damping.
// out: samples rows of joint values; nothing where samples is 0.
extern "C" void run(int count, const int* parents, const int* kinds, const double* numbers, int loop_count,
                    const double* loops, int spring_count, const double* springs, const double* torques,
                    const double* gravity, const double* q0, const double* v0, double end, int steps, int samples,
                    double w, double* out) {
    const auto still = Eigen::Matrix3d::Identity();
    Model model;
    model.gravity.linear(Point(gravity[0], gravity[1], gravity[2]));
    std::vector<JointIndex> joints;
    for (int i = 0; i < count; ++i) {
        const double* b = numbers + 10 * i;
        const JointIndex parent = parents[i] < 0 ? 0 : joints[parents[i]];
        const SE3 at(still, Point(b[0], b[1], b[2]));
        const JointModel joint_models[] = {JointModelRX(), JointModelRY(), JointModelRZ(),
                                           JointModelPX(), JointModelPY(), JointModelPZ()};
        joints.push_back(model.addJoint(parent, joint_models[kinds[i]], at, "j" + std::to_string(i)));
        const Eigen::Matrix3d about = Point(b[7], b[8], b[9]).asDiagonal();
        model.appendBodyToJoint(joints.back(), Inertia(b[3], Point(b[4], b[5], b[6]), about), SE3::Identity());
    }
    Loops constraints;
    for (int k = 0; k < loop_count; ++k) {
        const double* l = loops + 8 * k;
        RigidConstraintModel loop(CONTACT_3D, model, joints[int(l[0])], SE3(still, Point(l[1], l[2], l[3])),
                                  joints[int(l[4])], SE3(still, Point(l[5], l[6], l[7])), LOCAL);
        loop.baumgarte_corrector_parameters().Kp = w * w;
        loop.baumgarte_corrector_parameters().Kd = 2 * w;
        constraints.push_back(loop);
    }
    std::vector<Spring> pulls;
    for (int k = 0; k < spring_count; ++k) {
        const double* s = springs + 11 * k;
        pulls.push_back({s[0] < 0 ? 0 : joints[int(s[0])], joints[int(s[4])], Point(s[1], s[2], s[3]),
                         Point(s[5], s[6], s[7]), s[8], s[9], s[10]});
    }
    Data data(model);
    LoopData loop_data;
    for (const auto& loop : constraints) loop_data.push_back(loop.createData());
    initConstraintDynamics(model, data, constraints, loop_data);
    ProximalSettings proximal(1e-12, 1e-8, 20);
    // Joint i of the tree has index i in q and v: each has one freedom, and they were added in this order.
    Vector q = Eigen::Map<const Vector>(q0, count), v = Eigen::Map<const Vector>(v0, count);
    const Vector torque = Eigen::Map<const Vector>(torques, count);
    const PINOCCHIO_ALIGNED_STD_VECTOR(Force) none(model.joints.size(), Force::Zero());
    auto accelerations = [&](const Vector& q, const Vector& v) -> Vector {
        Vector tau = torque;
        if (!pulls.empty()) {
            forwardKinematics(model, data, q);
            Eigen::MatrixXd slope(6, count);
            computeJointJacobians(model, data, q);
            for (const Spring& spring : pulls) {
                const Point a = spring.one == 0 ? spring.at_one : data.oMi[spring.one].act(spring.at_one);
                const Point b = data.oMi[spring.other].act(spring.at_other);
                const Point way = a - b;
                const double length = way.norm();
                // The derivative of the length by the joints; its product with the velocities is the rate.
                Vector along = Vector::Zero(count);
                for (const auto& [joint, place, sign] :
                     {std::tuple(spring.other, b, -1.0), std::tuple(spring.one, a, 1.0)}) {
                    if (joint == 0) continue;
                    slope.setZero();
                    getJointJacobian(model, data, joint, WORLD, slope);
                    const Point direction = way / length, moment = place.cross(direction);
                    along += sign * (slope.topRows(3).transpose() * direction + slope.bottomRows(3).transpose() * moment);
                }
                tau -= (spring.stiffness * (length - spring.length) + spring.damping * along.dot(v)) * along;
            }
        }
        if (constraints.empty()) return aba(model, data, q, v, tau);
        proximal.iter = 0;
        return constraintDynamics(model, data, q, v, tau, constraints, loop_data, proximal);
    };
    const double h = end / steps;
    const int per = samples > 0 ? steps / samples : steps;
    for (int i = 1; i <= steps; ++i) {
        const Vector a1 = accelerations(q, v), v2 = v + h / 2 * a1;
        const Vector a2 = accelerations(q + h / 2 * v, v2), v3 = v + h / 2 * a2;
        const Vector a3 = accelerations(q + h / 2 * v2, v3), v4 = v + h * a3;
        const Vector a4 = accelerations(q + h * v3, v4);
        q += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
        v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
        if (samples > 0 && i % per == 0) Eigen::Map<Vector>(out + (i / per - 1) * count, count) = q;
    }
    if (samples == 0) out[0] = q[0];
}
