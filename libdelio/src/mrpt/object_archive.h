#pragma once
#include <mrpt/serialization/CArchive.h>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "files/gz.h"

namespace delio::io {
enum class FileOf { Scans, Keyframes, Scene };

/** Reads MRPT objects from a file that may be damaged, or made to do harm. MRPT makes an object of
 *  any class that a file names, makes room for as many elements as it claims before it reads any
 *  (and writes to address 0 where a cloud or a matrix gets none), and hands pictures to libjpeg,
 *  which ends the process where one is damaged. Here
 *  - only classes that such a file needs are read: another one throws, see refused();
 *  - what claims more elements than the rest of the file can hold (of a compressed file: than such
 *    an object has) throws std::length_error. Not seen are counts in the rarer shapes of a scene,
 *    and in four classes of rawlogs that have floats of their own counts that look like floats;
 *  - objects within objects within objects throw where the stack would end;
 *  - a movement of another kind of distribution than MRPT expects, which it would use unseen,
 *    throws, and so do a scene that holds anything but viewports, and a simplemap of version 0,
 *    whose poses MRPT uses whatever they are;
 *  - images are passed over and come out empty: nothing here looks at them. */
class ObjectArchive : public mrpt::serialization::CArchive {
 public:
    /** Which of the 2- and 4-byte numbers of an object are checked as counts of elements. */
    struct Counts {
        unsigned left = 0;       ///< so many to come
        std::uint64_t most = 0;  ///< elements that such an object has at most
        bool othersToo = false;  ///< among them are numbers that count nothing
        bool floatsToo = false;  ///< among them are floats
        unsigned skip = 0;       ///< so many before them are no counts
    };

    ObjectArchive(GzInput& in, FileOf file);
    std::string getArchiveDescription() const override { return "file"; }

    /** The next object. Throws as ReadObject() does, and as said above. */
    mrpt::serialization::CSerializable::Ptr next();
    /** The next object, which has to be of the class of this one, into it. */
    void nextInto(mrpt::serialization::CSerializable& object);

    /** The class that was not read, as MRPT calls it; empty if none was refused. */
    const std::string& refused() const { return refused_; }

 protected:
    std::size_t read(void* data, std::size_t count) override;
    std::size_t write(const void* data, std::size_t count) override {
        return in_.Write(data, count);
    }

 private:
    void begin(const char* stack);
    void checkDepth() const;
    void checkCount(const void* data, std::size_t bytes);
    void foresee(const void* data, std::size_t count);
    void foreseeClass(std::string_view name);
    void checkMovement(std::string_view className);
    void checkViewport(std::string_view className);
    void passOverImage(void* version, std::size_t count);

    GzInput& in_;
    FileOf file_;
    std::string refused_;
    const char* stack_ = nullptr;  ///< where it was when the object was begun
    enum class Next {
        Anything,
        ImageVersion,
        ImageIsExternal,
        SimplemapVersion
    } next_ = Next::Anything;
    /** What comes next of a CActionRobotMovement2D. */
    enum class Movement { None, Method, Odometry, Pdf } movement_ = Movement::None;
    /** Which of a scene's viewports comes next. */
    enum class Viewports { None, First, More } viewports_ = Viewports::None;
    std::ptrdiff_t viewportDepth_ = 0;  ///< how deep the stack was when a viewport was begun
    std::size_t nameSize_ = 0;          ///< if the next read is as long, it may be a class's name
    std::size_t oldNameSize_ = 0;  ///< the same, if three zeros come first: files from before 2008
    Counts counts_;
    std::uint64_t lastCount_ = 1;  ///< the number just before, if it was one: rows of columns
};
}  // namespace delio::io
