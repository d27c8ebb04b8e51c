def page(*a):
    print(a[4:6] + a[5:])
    return ""
