#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "bindings.h"
#include "delio/core/geometry.h"

namespace delio::python {
namespace {
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/** "float64 of shape (4, 4)", or the type of something that is no array. */
std::string describe(const py::handle& object) {
    if (!py::isinstance<py::array>(object))
        return py::str(py::type::of(object).attr("__name__")).cast<std::string>();
    const auto array = py::reinterpret_borrow<py::array>(object);
    return py::str(array.dtype()).cast<std::string>() + " of shape " +
           py::str(array.attr("shape")).cast<std::string>();
}
}  // namespace

py::array_t<double> arrayOf(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
    py::array_t<double> array({matrix.rows(), matrix.cols()});
    Eigen::Map<RowMajor>(array.mutable_data(), matrix.rows(), matrix.cols()) = matrix;
    return array;
}

py::array_t<double> arrayOf(const Eigen::Isometry3d& pose) {
    return arrayOf(Eigen::MatrixXd(pose.matrix()));
}

py::array_t<double> arrayOf(const std::vector<Eigen::Isometry3d>& poses) {
    py::array_t<double> array(
        {static_cast<py::ssize_t>(poses.size()), py::ssize_t{4}, py::ssize_t{4}});
    for (std::size_t i = 0; i < poses.size(); ++i)
        Eigen::Map<RowMajor>(array.mutable_data() + 16 * i, 4, 4) = poses[i].matrix();
    return array;
}

py::array_t<float> pointsArrayOf(const Eigen::Matrix3Xf& points) {
    py::array_t<float> array({points.cols(), Eigen::Index{3}});
    Eigen::Map<Eigen::Matrix3Xf>(array.mutable_data(), 3, points.cols()) = points;
    return array;
}

Eigen::Isometry3d poseIn(const py::handle& object, const std::string& name) {
    const auto array =
        py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(object);
    if (!array) PyErr_Clear();
    if (!array || array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4)
        throw Error("'" + name + "' must be an array of shape (4, 4), not " + describe(object));
    Eigen::Isometry3d pose;
    pose.matrix() = Eigen::Map<const RowMajor>(array.data(), 4, 4);
    const Eigen::Matrix3d R = pose.linear();
    const bool rigid = pose.matrix().allFinite() && R.determinant() > 0 &&
                       (R.transpose() * R - Eigen::Matrix3d::Identity()).norm() < 1e-2 &&
                       pose.matrix().row(3) == Eigen::RowVector4d(0, 0, 0, 1);
    if (!rigid)
        throw Error("'" + name +
                    "' must be a rigid motion: a rotation, a translation and the row 0 0 0 1");
    return pose;
}

Eigen::Vector3d vectorIn(const py::handle& object, const std::string& name) {
    const auto array =
        py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(object);
    if (!array) PyErr_Clear();
    if (!array || array.ndim() != 1 || array.shape(0) != 3)
        throw Error("'" + name + "' must be an array of shape (3,), not " + describe(object));
    return Eigen::Vector3d(array.data());
}

namespace {
constexpr int kDense = py::array::c_style | py::array::forcecast;

/** Calls put(numbers, rows) where `object` is an array of such numbers with shape (N, 3). An array
 *  in C order is not copied. */
template <class Number, class Put>
bool putRows(const py::handle& object, const Put& put) {
    if (!py::isinstance<py::array_t<Number>>(object)) return false;
    const auto array = py::array_t<Number, kDense>::ensure(object);
    if (array.ndim() != 2 || array.shape(1) != 3) return false;
    put(array.data(), static_cast<std::size_t>(array.shape(0)));
    return true;
}
}  // namespace

mrpt::maps::CPointsMap::Ptr cloudIn(const py::handle& object, const std::string& name,
                                    mrpt::maps::CPointsMap::Ptr cloud) {
    const auto put = [&](const auto* numbers, std::size_t rows) {
        cloud->resize(rows);
        for (std::size_t i = 0; i < rows; ++i)
            cloud->setPointFast(i, static_cast<float>(numbers[3 * i]),
                                static_cast<float>(numbers[3 * i + 1]),
                                static_cast<float>(numbers[3 * i + 2]));
        cloud->mark_as_modified();
    };
    if (!putRows<float>(object, put) && !putRows<double>(object, put))
        throw Error("'" + name + "' must be a float32 or float64 array of shape (N, 3), not " +
                    describe(object));
    return cloud;
}

template <class Number>
std::vector<Number> columnIn(const py::object& object, const std::string& name,
                             std::size_t points) {
    using Limits = std::numeric_limits<Number>;
    if (object.is_none()) return {};
    const std::string kinds = Limits::is_integer ? "iu" : "fiu";  // of numpy's types
    const bool isArray = py::isinstance<py::array>(object);
    const auto given = isArray ? py::reinterpret_borrow<py::array>(object) : py::array();
    if (!isArray || kinds.find(given.dtype().kind()) == std::string::npos || given.ndim() != 1 ||
        given.shape(0) != static_cast<py::ssize_t>(points))
        throw Error("'" + name + "' must be an array of " +
                    (Limits::is_integer ? "integers" : "numbers") + " of shape (" +
                    std::to_string(points) + ",), one for each point, not " + describe(object));
    if (py::isinstance<py::array_t<Number>>(object)) {
        const auto numbers = py::array_t<Number, kDense>::ensure(object);
        return {numbers.data(), numbers.data() + points};
    }
    const auto numbers = py::array_t<double, kDense>::ensure(object);
    if (Limits::is_integer &&
        std::any_of(numbers.data(), numbers.data() + points,
                    [](double number) { return number < 0 || number > Limits::max(); }))
        throw Error("'" + name + "' must be integers from 0 to " + std::to_string(Limits::max()));
    return {numbers.data(), numbers.data() + points};
}
template std::vector<float> columnIn(const py::object&, const std::string&, std::size_t);
template std::vector<std::uint16_t> columnIn(const py::object&, const std::string&, std::size_t);
}  // namespace delio::python
