; Functions that compiled PTX programs call: tracing of rays with Embree, hits of intersection
; programs, buffers, printing; and the loop over launch indices. Names with a dollar are offsets,
; which layout.py fills in.

declare void @rtcIntersect1(ptr, ptr, ptr)
declare void @llvm.x86.sse.ldmxcsr(ptr)
declare void @llvm.x86.sse.stmxcsr(ptr)
declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)

@nau.sampler = global ptr null
@nau.printer = global ptr null

define internal void @put32(ptr %base, i64 %offset, i32 %value) alwaysinline {
  %p = getelementptr i8, ptr %base, i64 %offset
  store i32 %value, ptr %p
  ret void
}

define internal void @putf(ptr %base, i64 %offset, float %value) alwaysinline {
  %p = getelementptr i8, ptr %base, i64 %offset
  store float %value, ptr %p
  ret void
}

define internal void @putp(ptr %base, i64 %offset, ptr %value) alwaysinline {
  %p = getelementptr i8, ptr %base, i64 %offset
  store ptr %value, ptr %p
  ret void
}

define internal i32 @get32(ptr %base, i64 %offset) alwaysinline {
  %p = getelementptr i8, ptr %base, i64 %offset
  %v = load i32, ptr %p
  ret i32 %v
}

define internal i64 @get64(ptr %base, i64 %offset) alwaysinline {
  %p = getelementptr i8, ptr %base, i64 %offset
  %v = load i64, ptr %p
  ret i64 %v
}

define internal float @getf(ptr %base, i64 %offset) alwaysinline {
  %p = getelementptr i8, ptr %base, i64 %offset
  %v = load float, ptr %p
  ret float %v
}

define internal ptr @getp(ptr %base, i64 %offset) alwaysinline {
  %p = getelementptr i8, ptr %base, i64 %offset
  %v = load ptr, ptr %p
  ret ptr %v
}

define void @nau.texture(i64 %handle, i32 %dimensions, float %x, float %y, float %z, ptr %out) nounwind {
  %sampler = load ptr, ptr @nau.sampler
  %none = icmp eq ptr %sampler, null
  br i1 %none, label %blank, label %ask
blank:
  store <4 x float> zeroinitializer, ptr %out, align 4
  ret void
ask:
  call void %sampler(i64 %handle, i32 %dimensions, float %x, float %y, float %z, ptr %out)
  ret void
}

; Throw an exception of the runtime.
define internal void @throw(ptr %launch, i32 %code, i32 %detail) {
  call void @put32(ptr %launch, i64 $launch_code, i32 %code)
  call void @put32(ptr %launch, i64 $launch_detail_0, i32 %detail)
  call void @put32(ptr %launch, i64 $launch_thrown, i32 1)
  ret void
}

; Return the record of a group for a ray type; null where there is none.
define internal ptr @record(ptr %launch, i32 %geometry, i32 %offset, i32 %stride) alwaysinline {
  %g = mul i32 %geometry, %stride
  %r = add i32 %g, %offset
  %count = call i32 @get32(ptr %launch, i64 $launch_hit_count)
  %known = icmp ult i32 %r, %count
  br i1 %known, label %take, label %none
take:
  %records = call ptr @getp(ptr %launch, i64 $launch_hit_records)
  %bytes = call i32 @get32(ptr %launch, i64 $launch_record_bytes)
  %r64 = zext i32 %r to i64
  %b64 = zext i32 %bytes to i64
  %byte = mul i64 %r64, %b64
  %record = getelementptr i8, ptr %records, i64 %byte
  ret ptr %record
none:
  ret ptr null
}

; Fill a frame for the programs of a primitive. %ray: an Embree ray.
define internal void @build(ptr %frame, ptr %query, ptr %ray, ptr %record, i32 %primitive, i32 %geometry) alwaysinline {
  %caller = call ptr @getp(ptr %query, i64 $query_caller)
  call void @llvm.memcpy.p0.p0.i64(ptr %frame, ptr %caller, i64 $FRAME, i1 false)
  %payload = call ptr @getp(ptr %query, i64 $query_payload)
  call void @putp(ptr %frame, i64 $frame_payload, ptr %payload)
  %data = getelementptr i8, ptr %record, i64 $HEADER
  call void @putp(ptr %frame, i64 $frame_record, ptr %data)
  %lo = getelementptr i8, ptr %frame, i64 $frame_origin_x
  call void @llvm.memcpy.p0.p0.i64(ptr %lo, ptr %ray, i64 12, i1 false)
  %ld = getelementptr i8, ptr %frame, i64 $frame_direction_x
  %rd = getelementptr i8, ptr %ray, i64 $ray_direction
  call void @llvm.memcpy.p0.p0.i64(ptr %ld, ptr %rd, i64 12, i1 false)
  %tmin = call float @getf(ptr %ray, i64 $ray_tmin)
  call void @putf(ptr %frame, i64 $frame_tmin, float %tmin)
  %flags = call i32 @get32(ptr %query, i64 $query_flags)
  call void @put32(ptr %frame, i64 $frame_flags, i32 %flags)
  call void @put32(ptr %frame, i64 $frame_primitive, i32 %primitive)
  call void @put32(ptr %frame, i64 $frame_group, i32 %geometry)
  call void @put32(ptr %frame, i64 $frame_status, i32 0)
  call void @putp(ptr %frame, i64 $frame_query, ptr %query)
  ret void
}

; Return 1 if a ray accepts a hit: its any-hit program, if there is one, may ignore it.
define internal i32 @offer(ptr %query, ptr %frame, ptr %record) {
  %flags = call i32 @get32(ptr %query, i64 $query_flags)
  %noany = and i32 %flags, 1
  %skip = icmp ne i32 %noany, 0
  br i1 %skip, label %accept, label %find
find:
  %program = call ptr @getp(ptr %record, i64 $record_any)
  %none = icmp eq ptr %program, null
  br i1 %none, label %accept, label %run
run:
  call void %program(ptr %frame)
  %launch = call ptr @getp(ptr %frame, i64 $frame_launch)
  %thrown = call i32 @get32(ptr %launch, i64 $launch_thrown)
  %isthrown = icmp ne i32 %thrown, 0
  br i1 %isthrown, label %broken, label %checked
broken:
  call void @put32(ptr %query, i64 $query_ended, i32 1)
  ret i32 0
checked:
  %status = call i32 @get32(ptr %frame, i64 $frame_status)
  %ignored = and i32 %status, $IGNORE
  %drop = icmp ne i32 %ignored, 0
  br i1 %drop, label %refuse, label %kept
refuse:
  ret i32 0
kept:
  %stop = and i32 %status, $TERMINATE
  %stops = icmp ne i32 %stop, 0
  br i1 %stops, label %end, label %accept
accept:
  %first = and i32 %flags, 4
  %only = icmp ne i32 %first, 0
  br i1 %only, label %end, label %done
end:
  call void @put32(ptr %query, i64 $query_ended, i32 1)
  br label %done
done:
  ret i32 1
}

; Run the intersection program of a record for a primitive. Return 1 if a hit was accepted.
define internal i32 @intersect(ptr %query, ptr %frame, ptr %program, i32 %primitive) {
  %argument = alloca i32
  store i32 %primitive, ptr %argument
  %best = call float @getf(ptr %query, i64 $query_best)
  call void @putf(ptr %frame, i64 $frame_tmax, float %best)
  %candidate = call ptr @getp(ptr %query, i64 $query_candidate)
  call void @putp(ptr %frame, i64 $frame_attributes, ptr %candidate)
  call void @put32(ptr %query, i64 $query_accepted, i32 0)
  call void %program(ptr %frame, ptr %argument)
  %taken = call i32 @get32(ptr %query, i64 $query_accepted)
  ret i32 %taken
}

; An intersection program proposes a distance. Return 1 if it can be a hit.
define i32 @nau.potential(ptr %frame, float %t) nounwind {
  %query = call ptr @getp(ptr %frame, i64 $frame_query)
  %none = icmp eq ptr %query, null
  br i1 %none, label %no, label %look
look:
  %tmin = call float @getf(ptr %frame, i64 $frame_tmin)
  %best = call float @getf(ptr %query, i64 $query_best)
  %late = fcmp ogt float %t, %tmin
  %near = fcmp olt float %t, %best
  %fits = and i1 %late, %near
  br i1 %fits, label %yes, label %no
yes:
  call void @putf(ptr %query, i64 $query_nearest, float %t)
  call void @put32(ptr %query, i64 $query_kind, i32 0)
  ret i32 1
no:
  ret i32 0
}

; An intersection program reports its hit. Return 1 if the ray accepts it.
define i32 @nau.report(ptr %frame) nounwind {
  %offered = alloca [$FRAME x i8], align 16
  %query = call ptr @getp(ptr %frame, i64 $frame_query)
  %none = icmp eq ptr %query, null
  br i1 %none, label %no, label %look
look:
  %ended = call i32 @get32(ptr %query, i64 $query_ended)
  %over = icmp ne i32 %ended, 0
  br i1 %over, label %no, label %ask
ask:
  call void @llvm.memcpy.p0.p0.i64(ptr %offered, ptr %frame, i64 $FRAME, i1 false)
  %t = call float @getf(ptr %query, i64 $query_nearest)
  call void @putf(ptr %offered, i64 $frame_tmax, float %t)
  %kind = call i32 @get32(ptr %query, i64 $query_kind)
  call void @put32(ptr %offered, i64 $frame_hit_kind, i32 %kind)
  call void @put32(ptr %offered, i64 $frame_status, i32 0)
  %data = call ptr @getp(ptr %frame, i64 $frame_record)
  %record = getelementptr i8, ptr %data, i64 -$HEADER
  %taken = call i32 @offer(ptr %query, ptr %offered, ptr %record)
  %is = icmp ne i32 %taken, 0
  br i1 %is, label %commit, label %no
commit:
  call void @putf(ptr %query, i64 $query_best, float %t)
  call void @put32(ptr %query, i64 $query_hit_kind, i32 %kind)
  call void @put32(ptr %query, i64 $query_accepted, i32 1)
  %launch = call ptr @getp(ptr %frame, i64 $frame_launch)
  %bytes = call i32 @get32(ptr %launch, i64 $launch_attribute_bytes)
  %b64 = zext i32 %bytes to i64
  %from = call ptr @getp(ptr %query, i64 $query_candidate)
  %to = call ptr @getp(ptr %query, i64 $query_committed)
  call void @llvm.memcpy.p0.p0.i64(ptr %to, ptr %from, i64 %b64, i1 false)
  ret i32 1
no:
  ret i32 0
}

; Propose and report a hit with its attributes, as one call of OptiX 7 does.
define i32 @nau.report7(ptr %frame, float %t, i32 %kind, ptr %words, i64 %bytes) nounwind {
  %may = call i32 @nau.potential(ptr %frame, float %t)
  %can = icmp ne i32 %may, 0
  br i1 %can, label %ask, label %no
ask:
  %query = call ptr @getp(ptr %frame, i64 $frame_query)
  call void @put32(ptr %query, i64 $query_kind, i32 %kind)
  %launch = call ptr @getp(ptr %frame, i64 $frame_launch)
  %room = call i32 @get32(ptr %launch, i64 $launch_attribute_bytes)
  %room64 = zext i32 %room to i64
  %fits = icmp ule i64 %bytes, %room64
  %size = select i1 %fits, i64 %bytes, i64 %room64
  %to = call ptr @getp(ptr %query, i64 $query_candidate)
  call void @llvm.memcpy.p0.p0.i64(ptr %to, ptr %words, i64 %size, i1 false)
  %taken = call i32 @nau.report(ptr %frame)
  ret i32 %taken
no:
  ret i32 0
}

; Return a word of a hit's attributes. Those of a triangle are its barycentric coordinates.
define i32 @nau.attribute(ptr %frame, i32 %index) nounwind {
  %words = call ptr @getp(ptr %frame, i64 $frame_attributes)
  %none = icmp eq ptr %words, null
  %base = getelementptr i8, ptr %frame, i64 $frame_u
  %from = select i1 %none, ptr %base, ptr %words
  %most = select i1 %none, i32 2, i32 8
  %known = icmp ult i32 %index, %most
  br i1 %known, label %take, label %no
take:
  %wide = zext i32 %index to i64
  %p = getelementptr i32, ptr %from, i64 %wide
  %v = load i32, ptr %p
  ret i32 %v
no:
  ret i32 0
}

; Filter a hit of Embree at one of its triangles.
define void @nau.filter(ptr %args) nounwind {
  %frame = alloca [$FRAME x i8], align 16
  %valid = call ptr @getp(ptr %args, i64 0)
  %query = call ptr @getp(ptr %args, i64 16)
  %ray = call ptr @getp(ptr %args, i64 24)
  %hit = call ptr @getp(ptr %args, i64 32)
  %is = load i32, ptr %valid
  %off = icmp eq i32 %is, 0
  br i1 %off, label %done, label %look
look:
  %ended = call i32 @get32(ptr %query, i64 $query_ended)
  %over = icmp ne i32 %ended, 0
  br i1 %over, label %refuse, label %find
find:
  %caller = call ptr @getp(ptr %query, i64 $query_caller)
  %launch = call ptr @getp(ptr %caller, i64 $frame_launch)
  %primitive = call i32 @get32(ptr %hit, i64 20)
  %geometry = call i32 @get32(ptr %hit, i64 24)
  %offset = call i32 @get32(ptr %query, i64 $query_offset)
  %stride = call i32 @get32(ptr %query, i64 $query_stride)
  %record = call ptr @record(ptr %launch, i32 %geometry, i32 %offset, i32 %stride)
  %t = call float @getf(ptr %ray, i64 $ray_tmax)
  %flags = call i32 @get32(ptr %query, i64 $query_flags)
  %unknown = icmp eq ptr %record, null
  br i1 %unknown, label %turn, label %own
own:
  %program = call ptr @getp(ptr %record, i64 $record_intersect)
  %none = icmp eq ptr %program, null
  br i1 %none, label %turn, label %told
told:
  call void @build(ptr %frame, ptr %query, ptr %ray, ptr %record, i32 %primitive, i32 %geometry)
  %reported = call i32 @intersect(ptr %query, ptr %frame, ptr %program, i32 %primitive)
  %hits = icmp ne i32 %reported, 0
  br i1 %hits, label %done, label %refuse
turn:
  %nx = call float @getf(ptr %hit, i64 0)
  %ny = call float @getf(ptr %hit, i64 4)
  %nz = call float @getf(ptr %hit, i64 8)
  %dx = call float @getf(ptr %ray, i64 16)
  %dy = call float @getf(ptr %ray, i64 20)
  %dz = call float @getf(ptr %ray, i64 24)
  %a = fmul float %nx, %dx
  %b = fmul float %ny, %dy
  %c = fmul float %nz, %dz
  %ab = fadd float %a, %b
  %dot = fadd float %ab, %c
  %back = fcmp ogt float %dot, 0.0
  %cullb = and i32 %flags, 16
  %cullf = and i32 %flags, 32
  %wantb = icmp ne i32 %cullb, 0
  %wantf = icmp ne i32 %cullf, 0
  %front = xor i1 %back, true
  %lostb = and i1 %wantb, %back
  %lostf = and i1 %wantf, %front
  %lost = or i1 %lostb, %lostf
  br i1 %lost, label %refuse, label %near
near:
  %tmin = call float @getf(ptr %ray, i64 $ray_tmin)
  %early = fcmp ole float %t, %tmin
  br i1 %early, label %refuse, label %ask
ask:
  br i1 %unknown, label %take, label %fill
fill:
  call void @build(ptr %frame, ptr %query, ptr %ray, ptr %record, i32 %primitive, i32 %geometry)
  %u = call float @getf(ptr %hit, i64 12)
  %v = call float @getf(ptr %hit, i64 16)
  call void @putf(ptr %frame, i64 $frame_u, float %u)
  call void @putf(ptr %frame, i64 $frame_v, float %v)
  call void @putf(ptr %frame, i64 $frame_tmax, float %t)
  call void @putp(ptr %frame, i64 $frame_attributes, ptr null)
  %kind = select i1 %back, i32 255, i32 254
  call void @put32(ptr %frame, i64 $frame_hit_kind, i32 %kind)
  %taken = call i32 @offer(ptr %query, ptr %frame, ptr %record)
  %accepted = icmp ne i32 %taken, 0
  br i1 %accepted, label %store, label %refuse
store:
  call void @put32(ptr %query, i64 $query_hit_kind, i32 %kind)
  br label %take
take:
  call void @putf(ptr %query, i64 $query_best, float %t)
  br label %done
refuse:
  store i32 0, ptr %valid
  ret void
done:
  ret void
}

; Intersect a primitive of user geometry (RTCIntersectFunctionNArguments, N = 1).
define void @nau.user(ptr %args) nounwind {
  %frame = alloca [$FRAME x i8], align 16
  %valid = call ptr @getp(ptr %args, i64 0)
  %primitive = call i32 @get32(ptr %args, i64 16)
  %query = call ptr @getp(ptr %args, i64 24)
  %ray = call ptr @getp(ptr %args, i64 32)
  %geometry = call i32 @get32(ptr %args, i64 44)
  %is = load i32, ptr %valid
  %off = icmp eq i32 %is, 0
  br i1 %off, label %done, label %look
look:
  %ended = call i32 @get32(ptr %query, i64 $query_ended)
  %over = icmp ne i32 %ended, 0
  br i1 %over, label %done, label %find
find:
  %caller = call ptr @getp(ptr %query, i64 $query_caller)
  %launch = call ptr @getp(ptr %caller, i64 $frame_launch)
  %offset = call i32 @get32(ptr %query, i64 $query_offset)
  %stride = call i32 @get32(ptr %query, i64 $query_stride)
  %record = call ptr @record(ptr %launch, i32 %geometry, i32 %offset, i32 %stride)
  %unknown = icmp eq ptr %record, null
  br i1 %unknown, label %done, label %own
own:
  %program = call ptr @getp(ptr %record, i64 $record_intersect)
  %none = icmp eq ptr %program, null
  br i1 %none, label %done, label %ask
ask:
  call void @build(ptr %frame, ptr %query, ptr %ray, ptr %record, i32 %primitive, i32 %geometry)
  %reported = call i32 @intersect(ptr %query, ptr %frame, ptr %program, i32 %primitive)
  %hits = icmp ne i32 %reported, 0
  br i1 %hits, label %store, label %done
store:
  %t = call float @getf(ptr %query, i64 $query_best)
  call void @putf(ptr %ray, i64 $ray_tmax, float %t)
  %hit = getelementptr i8, ptr %ray, i64 $hit
  store [5 x float] zeroinitializer, ptr %hit
  call void @put32(ptr %ray, i64 $hit_primitive, i32 %primitive)
  call void @put32(ptr %ray, i64 $hit_geometry, i32 %geometry)
  call void @put32(ptr %ray, i64 $hit_instance, i32 -1)
  br label %done
done:
  ret void
}

; Compute the box of a primitive (RTCBoundsFunctionArguments): its bounding box program writes six
; floats. User data: the program and a frame.
define void @nau.bounds(ptr %args) nounwind {
  %argument = alloca i32
  %address = alloca ptr
  %box = alloca [6 x float], align 16
  %user = call ptr @getp(ptr %args, i64 0)
  %primitive = call i32 @get32(ptr %args, i64 8)
  %out = call ptr @getp(ptr %args, i64 16)
  store i32 %primitive, ptr %argument
  store ptr %box, ptr %address
  store [6 x float] zeroinitializer, ptr %box
  %program = call ptr @getp(ptr %user, i64 0)
  %frame = call ptr @getp(ptr %user, i64 8)
  call void %program(ptr %frame, ptr %argument, ptr %address)
  %launch = call ptr @getp(ptr %frame, i64 $frame_launch)
  call void @put32(ptr %launch, i64 $launch_thrown, i32 0)
  call void @llvm.memcpy.p0.p0.i64(ptr %out, ptr %box, i64 12, i1 false)
  %upper = getelementptr i8, ptr %out, i64 16
  %last = getelementptr i8, ptr %box, i64 12
  call void @llvm.memcpy.p0.p0.i64(ptr %upper, ptr %last, i64 12, i1 false)
  ret void
}

; Compute the boxes of all primitives, eight floats each.
define void @nau.boxes(ptr %user, i64 %count, ptr %out) nounwind {
entry:
  %args = alloca [24 x i8], align 16
  call void @putp(ptr %args, i64 0, ptr %user)
  br label %test
test:
  %i = phi i64 [ 0, %entry ], [ %i1, %body ]
  %more = icmp ult i64 %i, %count
  br i1 %more, label %body, label %done
body:
  %i32 = trunc i64 %i to i32
  call void @put32(ptr %args, i64 8, i32 %i32)
  %byte = mul i64 %i, 32
  %to = getelementptr i8, ptr %out, i64 %byte
  call void @putp(ptr %args, i64 16, ptr %to)
  call void @nau.bounds(ptr %args)
  %i1 = add i64 %i, 1
  br label %test
done:
  ret void
}

; Run an intersection program for one ray, eight floats: origin, tmin, direction, tmax. Return the
; distance of the hit, less than zero for none.
define float @nau.probe(ptr %user, i32 %primitive, ptr %ray) nounwind {
  %frame = alloca [$FRAME x i8], align 16
  %query = alloca [$QUERY x i8], align 16
  %embree = alloca [96 x i8], align 16
  store [$QUERY x i8] zeroinitializer, ptr %query
  store [96 x i8] zeroinitializer, ptr %embree
  %program = call ptr @getp(ptr %user, i64 0)
  %caller = call ptr @getp(ptr %user, i64 8)
  %launch = call ptr @getp(ptr %caller, i64 $frame_launch)
  %bytes = call i32 @get32(ptr %launch, i64 $launch_attribute_bytes)
  %b64 = zext i32 %bytes to i64
  %candidate = alloca i8, i64 %b64, align 16
  %committed = alloca i8, i64 %b64, align 16
  call void @putp(ptr %query, i64 $query_candidate, ptr %candidate)
  call void @putp(ptr %query, i64 $query_committed, ptr %committed)
  call void @putp(ptr %query, i64 $query_caller, ptr %caller)
  call void @put32(ptr %query, i64 $query_flags, i32 1)
  call void @llvm.memcpy.p0.p0.i64(ptr %embree, ptr %ray, i64 28, i1 false)
  %tplace = getelementptr i8, ptr %ray, i64 28
  %tmax = load float, ptr %tplace
  call void @putf(ptr %query, i64 $query_best, float %tmax)
  %data = call ptr @getp(ptr %caller, i64 $frame_record)
  %record = getelementptr i8, ptr %data, i64 -$HEADER
  call void @build(ptr %frame, ptr %query, ptr %embree, ptr %record, i32 %primitive, i32 0)
  %taken = call i32 @intersect(ptr %query, ptr %frame, ptr %program, i32 %primitive)
  call void @put32(ptr %launch, i64 $launch_thrown, i32 0)
  %hits = icmp ne i32 %taken, 0
  %t = call float @getf(ptr %query, i64 $query_best)
  %found = select i1 %hits, float %t, float -1.0
  ret float %found
}

define void @nau.trace(ptr %caller, i64 %handle, float %ox, float %oy, float %oz, float %dx, float %dy, float %dz, float %tmin, float %tmax, float %time, i32 %mask, i32 %flags, i32 %offset, i32 %stride, i32 %miss, ptr %payload) nounwind {
entry:
  %rh = alloca [96 x i8], align 16
  %q = alloca [48 x i8], align 16
  %query = alloca [$QUERY x i8], align 16
  %frame = alloca [$FRAME x i8], align 16
  %launch = call ptr @getp(ptr %caller, i64 $frame_launch)
  %room = call i32 @get32(ptr %launch, i64 $launch_attribute_bytes)
  %room64 = zext i32 %room to i64
  %candidate = alloca i8, i64 %room64, align 16
  %committed = alloca i8, i64 %room64, align 16
  %depth = call i32 @get32(ptr %caller, i64 $frame_depth)
  %next = add i32 %depth, 1
  %most = call i32 @get32(ptr %launch, i64 $launch_max_depth)
  %deep = icmp ugt i32 %next, %most
  br i1 %deep, label %lost, label %count
lost:
  %code = call i32 @get32(ptr %launch, i64 $launch_overflow)
  call void @throw(ptr %launch, i32 %code, i32 %most)
  ret void
count:
  %rays = call ptr @getp(ptr %launch, i64 $launch_rays)
  %kind0 = icmp ult i32 %offset, 16
  %kind1 = select i1 %kind0, i32 %offset, i32 15
  %kind2 = zext i32 %kind1 to i64
  %slot = getelementptr i64, ptr %rays, i64 %kind2
  %before = load i64, ptr %slot
  %after = add i64 %before, 1
  store i64 %after, ptr %slot
  call void @llvm.memcpy.p0.p0.i64(ptr %frame, ptr %caller, i64 $FRAME, i1 false)
  call void @putp(ptr %frame, i64 $frame_payload, ptr %payload)
  call void @putp(ptr %frame, i64 $frame_attributes, ptr null)
  call void @putp(ptr %frame, i64 $frame_query, ptr null)
  call void @putf(ptr %frame, i64 $frame_origin_x, float %ox)
  call void @putf(ptr %frame, i64 $frame_origin_y, float %oy)
  call void @putf(ptr %frame, i64 $frame_origin_z, float %oz)
  call void @putf(ptr %frame, i64 $frame_direction_x, float %dx)
  call void @putf(ptr %frame, i64 $frame_direction_y, float %dy)
  call void @putf(ptr %frame, i64 $frame_direction_z, float %dz)
  call void @put32(ptr %frame, i64 $frame_ray_type, i32 %offset)
  call void @putf(ptr %frame, i64 $frame_tmin, float %tmin)
  call void @putf(ptr %frame, i64 $frame_tmax, float %tmax)
  call void @putf(ptr %frame, i64 $frame_time, float %time)
  call void @put32(ptr %frame, i64 $frame_flags, i32 %flags)
  call void @put32(ptr %frame, i64 $frame_mask, i32 %mask)
  call void @put32(ptr %frame, i64 $frame_depth, i32 %next)
  %s2 = fadd float %ox, %oy
  %s3 = fadd float %oz, %dx
  %s4 = fadd float %dy, %dz
  %s5 = fadd float %s2, %s3
  %s6 = fadd float %s5, %s4
  %s7 = fsub float %s6, %s6
  %finite = fcmp oeq float %s7, 0.0
  %ordered = fcmp olt float %tmin, %tmax
  %scene = call ptr @getp(ptr %launch, i64 $launch_scene)
  %isscene = icmp ne i64 %handle, 0
  %ok1 = and i1 %finite, %ordered
  %seen = and i32 %mask, 255
  %visible = icmp ne i32 %seen, 0
  %ok2 = and i1 %ok1, %visible
  %ok = and i1 %ok2, %isscene
  br i1 %ok, label %ask, label %missed
ask:
  call void @putf(ptr %rh, i64 0, float %ox)
  call void @putf(ptr %rh, i64 4, float %oy)
  call void @putf(ptr %rh, i64 8, float %oz)
  call void @putf(ptr %rh, i64 12, float %tmin)
  call void @putf(ptr %rh, i64 16, float %dx)
  call void @putf(ptr %rh, i64 20, float %dy)
  call void @putf(ptr %rh, i64 24, float %dz)
  call void @putf(ptr %rh, i64 28, float 0.0)
  call void @putf(ptr %rh, i64 32, float %tmax)
  call void @put32(ptr %rh, i64 36, i32 -1)
  call void @put32(ptr %rh, i64 40, i32 0)
  call void @put32(ptr %rh, i64 44, i32 0)
  call void @put32(ptr %rh, i64 72, i32 -1)
  call void @put32(ptr %rh, i64 76, i32 -1)
  call void @put32(ptr %rh, i64 80, i32 -1)
  call void @put32(ptr %q, i64 0, i32 2)
  call void @put32(ptr %q, i64 4, i32 -1)
  call void @putp(ptr %q, i64 8, ptr %query)
  call void @putp(ptr %q, i64 16, ptr @nau.filter)
  call void @putp(ptr %q, i64 24, ptr null)
  call void @putp(ptr %q, i64 32, ptr null)
  store [$QUERY x i8] zeroinitializer, ptr %query
  call void @put32(ptr %query, i64 $query_instance, i32 -1)
  call void @put32(ptr %query, i64 $query_instance_primitive, i32 -1)
  call void @putp(ptr %query, i64 $query_caller, ptr %frame)
  call void @putp(ptr %query, i64 $query_payload, ptr %payload)
  call void @putp(ptr %query, i64 $query_candidate, ptr %candidate)
  call void @putp(ptr %query, i64 $query_committed, ptr %committed)
  call void @put32(ptr %query, i64 $query_offset, i32 %offset)
  call void @put32(ptr %query, i64 $query_stride, i32 %stride)
  call void @put32(ptr %query, i64 $query_flags, i32 %flags)
  call void @putf(ptr %query, i64 $query_best, float %tmax)
  call void @rtcIntersect1(ptr %scene, ptr %rh, ptr %q)
  %thrown = call i32 @get32(ptr %launch, i64 $launch_thrown)
  %isthrown = icmp ne i32 %thrown, 0
  br i1 %isthrown, label %done, label %whole
whole:
  %geometry = call i32 @get32(ptr %rh, i64 $hit_geometry)
  %hit = icmp ne i32 %geometry, -1
  br i1 %hit, label %found, label %missed
found:
  %noclosest = and i32 %flags, 8
  %skip = icmp ne i32 %noclosest, 0
  br i1 %skip, label %done, label %shade
shade:
  %record = call ptr @record(ptr %launch, i32 %geometry, i32 %offset, i32 %stride)
  %unknown = icmp eq ptr %record, null
  br i1 %unknown, label %done, label %take
take:
  %program = call ptr @getp(ptr %record, i64 $record_closest)
  %none = icmp eq ptr %program, null
  br i1 %none, label %done, label %run
run:
  %data = getelementptr i8, ptr %record, i64 $HEADER
  call void @putp(ptr %frame, i64 $frame_record, ptr %data)
  %own = call ptr @getp(ptr %record, i64 $record_intersect)
  %triangle = icmp eq ptr %own, null
  %told = select i1 %triangle, ptr null, ptr %committed
  call void @putp(ptr %frame, i64 $frame_attributes, ptr %told)
  %prim = call i32 @get32(ptr %rh, i64 $hit_primitive)
  %u = call float @getf(ptr %rh, i64 $hit_u)
  %v = call float @getf(ptr %rh, i64 $hit_v)
  %t = call float @getf(ptr %query, i64 $query_best)
  %kind = call i32 @get32(ptr %query, i64 $query_hit_kind)
  call void @put32(ptr %frame, i64 $frame_primitive, i32 %prim)
  call void @putf(ptr %frame, i64 $frame_u, float %u)
  call void @putf(ptr %frame, i64 $frame_v, float %v)
  call void @putf(ptr %frame, i64 $frame_tmax, float %t)
  call void @put32(ptr %frame, i64 $frame_hit_kind, i32 %kind)
  call void @put32(ptr %frame, i64 $frame_group, i32 %geometry)
  call void %program(ptr %frame)
  br label %done
missed:
  %mcount = call i32 @get32(ptr %launch, i64 $launch_miss_count)
  %mknown = icmp ult i32 %miss, %mcount
  br i1 %mknown, label %mtake, label %done
mtake:
  %mrecords = call ptr @getp(ptr %launch, i64 $launch_miss_records)
  %bytes = call i32 @get32(ptr %launch, i64 $launch_record_bytes)
  %m64 = zext i32 %miss to i64
  %bytes64 = zext i32 %bytes to i64
  %mbyte = mul i64 %m64, %bytes64
  %mrecord = getelementptr i8, ptr %mrecords, i64 %mbyte
  %mprogram = call ptr @getp(ptr %mrecord, i64 $record_closest)
  %mnone = icmp eq ptr %mprogram, null
  br i1 %mnone, label %done, label %mrun
mrun:
  %mdata = getelementptr i8, ptr %mrecord, i64 $HEADER
  call void @putp(ptr %frame, i64 $frame_record, ptr %mdata)
  call void %mprogram(ptr %frame)
  br label %done
done:
  ret void
}

; Return the address of a buffer's element (OptiX 6). Throw where there is none.
define i64 @nau.element(ptr %frame, i64 %buffer, i32 %size, i64 %i, i64 %j, i64 %k) nounwind {
  %b = inttoptr i64 %buffer to ptr
  %data = call i64 @get64(ptr %b, i64 0)
  %width = call i64 @get64(ptr %b, i64 8)
  %height = call i64 @get64(ptr %b, i64 16)
  %depth = call i64 @get64(ptr %b, i64 24)
  %bytes = call i32 @get32(ptr %b, i64 32)
  %in1 = icmp ult i64 %i, %width
  %in2 = icmp ult i64 %j, %height
  %in3 = icmp ult i64 %k, %depth
  %same = icmp eq i32 %size, %bytes
  %in12 = and i1 %in1, %in2
  %in123 = and i1 %in12, %in3
  %fits = and i1 %in123, %same
  br i1 %fits, label %take, label %wrong
take:
  %row = mul i64 %k, %height
  %row1 = add i64 %row, %j
  %cell = mul i64 %row1, %width
  %cell1 = add i64 %cell, %i
  %size64 = zext i32 %size to i64
  %byte = mul i64 %cell1, %size64
  %at = add i64 %data, %byte
  ret i64 %at
wrong:
  %launch = call ptr @getp(ptr %frame, i64 $frame_launch)
  call void @throw(ptr %launch, i32 $BUFFER_INDEX, i32 %bytes)
  ret i64 0
}

; Return the address of a callable program. Throw where there is none.
define i64 @nau.callable(ptr %frame, i32 %index) nounwind {
  %launch = call ptr @getp(ptr %frame, i64 $frame_launch)
  %count = call i32 @get32(ptr %launch, i64 $launch_callable_count)
  %known = icmp ult i32 %index, %count
  br i1 %known, label %take, label %wrong
take:
  %table = call ptr @getp(ptr %launch, i64 $launch_callables)
  %wide = zext i32 %index to i64
  %p = getelementptr i64, ptr %table, i64 %wide
  %found = load i64, ptr %p
  ret i64 %found
wrong:
  call void @throw(ptr %launch, i32 $NO_CALLABLE, i32 %index)
  ret i64 0
}

; Return the corners of a triangle, nine floats, from Nau's record of its group.
define void @nau.vertices(ptr %frame, i32 %primitive, i32 %group, ptr %out) nounwind {
entry:
  store [9 x float] zeroinitializer, ptr %out
  %launch = call ptr @getp(ptr %frame, i64 $frame_launch)
  %types = call i32 @get32(ptr %launch, i64 $launch_types)
  %record = call ptr @record(ptr %launch, i32 %group, i32 0, i32 %types)
  %none = icmp eq ptr %record, null
  br i1 %none, label %done, label %look
look:
  %indices = call ptr @getp(ptr %record, i64 $HEADER)
  %place = getelementptr i8, ptr %record, i64 8
  %positions = call ptr @getp(ptr %place, i64 $HEADER)
  %first = zext i32 %primitive to i64
  %three = mul i64 %first, 3
  br label %corner
corner:
  %c = phi i64 [ 0, %look ], [ %c1, %corner ]
  %at = add i64 %three, %c
  %ip = getelementptr i32, ptr %indices, i64 %at
  %i = load i32, ptr %ip
  %wide = zext i32 %i to i64
  %from = getelementptr [4 x float], ptr %positions, i64 %wide
  %byte = mul i64 %c, 12
  %to = getelementptr i8, ptr %out, i64 %byte
  call void @llvm.memcpy.p0.p0.i64(ptr %to, ptr %from, i64 12, i1 false)
  %c1 = add i64 %c, 1
  %more = icmp ult i64 %c1, 3
  br i1 %more, label %corner, label %done
done:
  ret void
}

; Pass a printed text to the host: launch index, format, values, and 1 where the values are words
; with types (OptiX 6).
define internal void @print(ptr %launch, i64 %format, i64 %values, i32 %typed) {
  %printer = load ptr, ptr @nau.printer
  %none = icmp eq ptr %printer, null
  br i1 %none, label %done, label %ask
ask:
  %mark = call ptr @getp(ptr %launch, i64 $launch_mark)
  %index = load i64, ptr %mark
  call void %printer(i64 %index, i64 %format, i64 %values, i32 %typed)
  br label %done
done:
  ret void
}

define void @nau.printf(ptr %frame, i64 %format, i64 %values) nounwind {
  %launch = call ptr @getp(ptr %frame, i64 $frame_launch)
  call void @print(ptr %launch, i64 %format, i64 %values, i32 0)
  ret void
}

define internal void @print_end(ptr %launch) {
  %format = call i64 @get64(ptr %launch, i64 $launch_format)
  %some = icmp ne i64 %format, 0
  br i1 %some, label %print, label %done
print:
  %words = getelementptr i8, ptr %launch, i64 $launch_printed_0
  %values = ptrtoint ptr %words to i64
  call void @print(ptr %launch, i64 %format, i64 %values, i32 1)
  %p = getelementptr i8, ptr %launch, i64 $launch_format
  store i64 0, ptr %p
  br label %done
done:
  ret void
}

define void @nau.print_start(ptr %frame, i64 %format) nounwind {
  %launch = call ptr @getp(ptr %frame, i64 $frame_launch)
  call void @print_end(ptr %launch)
  %p = getelementptr i8, ptr %launch, i64 $launch_format
  store i64 %format, ptr %p
  ret void
}

define void @nau.print_write(ptr %frame, i32 %value, i32 %at) nounwind {
  %launch = call ptr @getp(ptr %frame, i64 $frame_launch)
  %behind = sub i32 %at, 4
  %word = lshr i32 %behind, 2
  %known = icmp ult i32 %word, $PRINTED
  br i1 %known, label %take, label %done
take:
  %words = getelementptr i8, ptr %launch, i64 $launch_printed_0
  %wide = zext i32 %word to i64
  %p = getelementptr i32, ptr %words, i64 %wide
  store i32 %value, ptr %p
  br label %done
done:
  ret void
}

; Run the ray generation program for the launch indices from begin to end. Denormals are zero where
; the launch flushes them (SSE: flush to zero, denormals are zero).
define void @nau.launch(ptr %program, ptr %launch, i64 %begin, i64 %end) nounwind {
entry:
  %frame = alloca [$FRAME x i8], align 16
  %old = alloca i32
  %now = alloca i32
  call void @llvm.x86.sse.stmxcsr(ptr %old)
  %word = load i32, ptr %old
  %wanted = call i32 @get32(ptr %launch, i64 $launch_flush)
  %on = icmp ne i32 %wanted, 0
  %bits = select i1 %on, i32 32832, i32 0
  %flush = or i32 %word, %bits
  store i32 %flush, ptr %now
  call void @llvm.x86.sse.ldmxcsr(ptr %now)
  %width = call i32 @get32(ptr %launch, i64 $launch_width)
  %height = call i32 @get32(ptr %launch, i64 $launch_height)
  %w64 = zext i32 %width to i64
  %h64 = zext i32 %height to i64
  %record = call ptr @getp(ptr %launch, i64 $launch_raygen_record)
  %mark = call ptr @getp(ptr %launch, i64 $launch_mark)
  %exception = call ptr @getp(ptr %launch, i64 $launch_exception)
  %noexception = icmp eq ptr %exception, null
  %indices = call ptr @getp(ptr %launch, i64 $launch_indices)
  %all = icmp eq ptr %indices, null
  br label %test
test:
  %i = phi i64 [ %begin, %entry ], [ %i1, %next ]
  %more = icmp ult i64 %i, %end
  br i1 %more, label %choose, label %done
choose:
  br i1 %all, label %body, label %pick
pick:
  %ip = getelementptr i64, ptr %indices, i64 %i
  %picked = load i64, ptr %ip
  br label %body
body:
  %index = phi i64 [ %i, %choose ], [ %picked, %pick ]
  store [$FRAME x i8] zeroinitializer, ptr %frame
  call void @putp(ptr %frame, i64 $frame_launch, ptr %launch)
  call void @putp(ptr %frame, i64 $frame_record, ptr %record)
  %x = urem i64 %index, %w64
  %rest = udiv i64 %index, %w64
  %y = urem i64 %rest, %h64
  %z = udiv i64 %rest, %h64
  %x32 = trunc i64 %x to i32
  %y32 = trunc i64 %y to i32
  %z32 = trunc i64 %z to i32
  call void @put32(ptr %frame, i64 $frame_index_x, i32 %x32)
  call void @put32(ptr %frame, i64 $frame_index_y, i32 %y32)
  call void @put32(ptr %frame, i64 $frame_index_z, i32 %z32)
  store volatile i64 %index, ptr %mark
  call void %program(ptr %frame)
  %thrown = call i32 @get32(ptr %launch, i64 $launch_thrown)
  %isthrown = icmp ne i32 %thrown, 0
  br i1 %isthrown, label %caught, label %printed
caught:
  call void @put32(ptr %launch, i64 $launch_thrown, i32 0)
  %code = call i32 @get32(ptr %launch, i64 $launch_code)
  call void @put32(ptr %frame, i64 $frame_code, i32 %code)
  %count = call i32 @get32(ptr %launch, i64 $launch_thrown_count)
  %count1 = add i32 %count, 1
  call void @put32(ptr %launch, i64 $launch_thrown_count, i32 %count1)
  %isfirst = icmp eq i32 %count, 0
  br i1 %isfirst, label %first, label %handle
first:
  call void @put32(ptr %launch, i64 $launch_first_code, i32 %code)
  %fp = getelementptr i8, ptr %launch, i64 $launch_first_thrown
  store i64 %index, ptr %fp
  br label %handle
handle:
  br i1 %noexception, label %printed, label %except
except:
  call void %exception(ptr %frame)
  call void @put32(ptr %launch, i64 $launch_thrown, i32 0)
  br label %printed
printed:
  call void @print_end(ptr %launch)
  br label %next
next:
  %i1 = add i64 %i, 1
  br label %test
done:
  call void @llvm.x86.sse.ldmxcsr(ptr %old)
  ret void
}
