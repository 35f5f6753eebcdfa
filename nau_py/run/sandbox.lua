-- Removes from a new Lua state what scripts may not use, and limits the rest. Runs once, before any
-- script. Arguments: the limit of instructions, a function that returns whether a call is running,
-- and a function that takes lines of output.
local limit, running, write = ...
local sethook, errors = debug.sethook, error

-- When a call has used up its instructions, every further one is an error, so that pcall cannot go
-- on.
local function stop()
    if not running() then
        sethook()
        return
    end
    sethook(stop, "", 1)
    errors("it runs longer than " .. limit .. " instructions", 0)
end

local function begin()
    sethook(stop, "", limit)
end

local function finish()
    sethook()
end

for _, name in ipairs({
    "os", "io", "package", "debug", "coroutine", "require", "dofile", "loadfile", "load",
    "loadstring", "collectgarbage", "python", "jit",
}) do
    _G[name] = nil
end

-- Pattern matching and long repetition run inside C, where no hook reaches.
local find, rep = string.find, string.rep
for _, name in ipairs({ "match", "gmatch", "gsub", "dump", "pack", "unpack", "packsize" }) do
    string[name] = nil
end
string.find = function(text, what, from)
    return find(text, what, from, true)
end
string.rep = function(text, count, between)
    if #text * count > 1000000 then
        errors("string.rep makes more than a million bytes", 2)
    end
    return rep(text, count, between)
end
math.randomseed(0)
math.randomseed = nil

print = function(...)
    local words = {}
    for index = 1, select("#", ...) do
        words[index] = tostring((select(index, ...)))
    end
    write(table.concat(words, "\t"))
end

-- Files to be written take what they are given and leave nothing on the disk; none can be read.
local sink = {
    write = function(self, ...)
        for index = 1, select("#", ...) do
            write(tostring((select(index, ...))))
        end
        return self
    end,
    close = function()
        return true
    end,
}
io = {
    open = function(name, mode)
        mode = mode or "r"
        if mode == "w" or mode == "a" then
            return sink
        end
        return nil, tostring(name) .. ": scripts read no files"
    end,
}

return begin, finish
