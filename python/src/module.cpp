#include <tbb/global_control.h>

#include <exception>
#include <memory>
#include <new>
#include <utility>

#include "bindings.h"
#include "delio/version.h"

namespace delio::python {
namespace {
/** Limit of TBB's threads in this process; null: all cores. */
std::unique_ptr<tbb::global_control>& threadLimit() {
    static std::unique_ptr<tbb::global_control> limit;
    return limit;
}

void setThreads(unsigned count) {
    threadLimit().reset();
    if (count > 0)
        threadLimit() = std::make_unique<tbb::global_control>(
            tbb::global_control::max_allowed_parallelism, count);
}

/** What MRPT and others throw becomes an Error with one plain line, too. */
void translate(std::exception_ptr thrown, const py::object& error) {
    try {
        std::rethrow_exception(std::move(thrown));
    } catch (const py::error_already_set&) {
        throw;
    } catch (const py::builtin_exception&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {
        PyErr_SetString(error.ptr(), plainMessage(e).c_str());
    }
}

void bindModule(py::module_& module) {
    module.attr("__version__") = kVersion;
    static PyObject* error = PyErr_NewExceptionWithDoc(
        "delio.Error", "One plain line: what failed, where, and what to do.", PyExc_RuntimeError,
        nullptr);
    module.add_object("Error", py::handle(error));
    py::register_local_exception_translator([](std::exception_ptr thrown) {
        if (thrown) translate(std::move(thrown), py::reinterpret_borrow<py::object>(error));
    });
    module.def("profiles", &Options::profileNames, "Names of the profiles, a list of str.");
    module.def("set_threads", &setThreads, py::arg("count"),
               "Number of threads that DeLiO uses in this process; 0: all cores, the default. "
               "Results have the same bytes for any number.");
}
}  // namespace
}  // namespace delio::python

PYBIND11_MODULE(_delio, module) {
    using namespace delio::python;
    module.doc() = "DeLiO: LiDAR odometry and mapping. Import the package `delio`.";
    bindModule(module);
    bindScans(module);
    bindImu(module);
    bindWheels(module);
    bindSteps(module);
    bindOdometry(module);
    bindTrajectories(module);
    bindEvaluation(module);
    bindRun(module);
    bindSlam(module);
    bindPlaces(module);
    bindAlign(module);
}
